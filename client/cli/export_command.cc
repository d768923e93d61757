#include <memory>

#include "absl/strings/str_cat.h"
#include "client/cli/application.h"
#include "client/cli/result_files.h"
#include "client/cli/run_record.h"
#include "client/cli/simulation_calls.h"
#include "client/cpp/io/result_folder.h"

namespace lipofill::client {
namespace {

struct Options {
  std::string simulation;
  std::string out;
};

absl::StatusOr<ExitCode> export_simulation(Application& application, const Options& options) {
  const Connection connection = application.connect();
  const auto simulation = get_simulation(connection, options.simulation);
  if (!simulation.ok()) return simulation.status();
  const auto meshes = mesh_names(connection, *simulation);
  if (!meshes.ok()) return meshes.status();
  auto state = final_state(connection, *simulation, *meshes);
  if (!state.ok()) return state.status();
  std::vector<v1::SeriesRow> rows;
  if (auto status = fetch_series(connection, simulation->name(), &rows); !status.ok()) return status;
  const auto record = record_of_simulation(connection, *simulation);
  if (!record.ok()) return record.status();

  ResultFolder folder(options.out);
  if (auto status = folder.prepare(); !status.ok()) return status;
  folder.set_meshes(std::move(state->meshes.arrays));
  if (auto status = folder.write_frame(state->frame.time_s, state->frame.fields); !status.ok()) return status;
  if (auto status = write_figures(folder.path(), record->plan, *simulation, rows); !status.ok()) return status;
  if (auto status = write_run_record(folder.path(), *record); !status.ok()) return status;
  return application.done(absl::StrCat("wrote the final state of ", simulation->name(), " to ", options.out));
}

}  // namespace

void add_export_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_command(root, application, "export",
                                  "Write the final state of a simulation for ParaView, with its series and summary",
                                  "  lipofill export simulations/abc --out result\n",
                                  [&application, options] { return export_simulation(application, *options); });
  command->add_option("simulation", options->simulation, "simulations/ID, or the ID alone")->required();
  command->add_option("--out", options->out, "folder")->required();
}

}  // namespace lipofill::client
