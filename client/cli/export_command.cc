#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/cli/application.h"
#include "client/cli/listing.h"
#include "client/cli/progress_line.h"
#include "client/cli/result_files.h"
#include "client/cpp/tissue_deck.h"

namespace lipofill::client {
namespace {

struct Options {
  std::string simulation;
  std::string out;
  std::string deck;
};

/// The tissue under its present load, for another solver.
absl::StatusOr<std::string> export_deck(const Application& application, const Connection& connection,
                                        const Options& options) {
  ProgressLine progress(application.json);
  const std::string name = full_name("simulations", options.simulation);
  const auto deck = download_tissue_deck(connection, name, options.deck, [&progress](uint64_t bytes) {
    progress.show(absl::StrFormat("deck %.1f MB", static_cast<double>(bytes) * 1e-6));
  });
  progress.finish();
  if (!deck.ok()) return deck.status();
  return absl::StrFormat("wrote the tissue of %s at %g s to %s", name, deck->time_s, options.deck);
}

absl::StatusOr<ExitCode> export_simulation(Application& application, const Options& options) {
  if (options.out.empty() && options.deck.empty()) {
    return absl::InvalidArgumentError("--out FOLDER, --deck FILE or both are needed: what to write, and where to");
  }
  const Connection connection = application.connect();
  std::vector<std::string> done;
  if (!options.out.empty()) {
    auto text = export_result(connection, options.simulation, options.out);
    if (!text.ok()) return text.status();
    done.push_back(*std::move(text));
  }
  if (!options.deck.empty()) {
    auto text = export_deck(application, connection, options);
    if (!text.ok()) return text.status();
    done.push_back(*std::move(text));
  }
  return application.done(absl::StrJoin(done, "\n"));
}

}  // namespace

void add_export_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      root, application, "export",
      "Write the final state of a simulation for ParaView, with its series and summary; or its tissue under the "
      "present pressure as an Abaqus/CalculiX deck, for a second opinion by another solver",
      "  lipofill export simulations/abc --out result\n"
      "  lipofill export simulations/abc --deck tissue.inp && ccx tissue\n",
      [&application, options] { return export_simulation(application, *options); });
  command->add_option("simulation", options->simulation, "simulations/ID, or the ID alone")->required();
  command->add_option("--out", options->out, "folder for the final state, once the simulation has ended");
  command
      ->add_option("--deck", options->deck,
                   "file for the tissue's deck (mm, N, MPa): mesh, supports and the films' pressure as they are now, "
                   "or were at the end")
      ->type_name("FILE.inp");
}

}  // namespace lipofill::client
