#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/application.h"
#include "client/cli/listing.h"
#include "client/cpp/result_text.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::SimulationService;
using Stub = SimulationService::Stub;

struct Options {
  std::string name;
  std::string id;
  std::string request_id;
  std::string display_name;
  bool as_new = false;
  bool start = false;
};

std::string checkpoint_line(const v1::Checkpoint& checkpoint) {
  return absl::StrFormat("%s  step %d  %.3f s  %.1f kB%s%s\n", checkpoint.name(), checkpoint.step(),
                         checkpoint.time_s(), 1e-3 * static_cast<double>(checkpoint.size_bytes()),
                         checkpoint.automatic() ? "  automatic" : "", checkpoint.on_course() ? "" : "  off course");
}

absl::StatusOr<ExitCode> keep(Application& application, const Options& options) {
  v1::CreateCheckpointRequest request;
  request.set_parent(full_name("simulations", options.name));
  request.set_checkpoint_id(options.id);
  request.set_request_id(options.request_id);
  const auto checkpoint = application.connect().call<SimulationService>(&Stub::CreateCheckpoint, request);
  if (!checkpoint.ok()) return checkpoint.status();
  return application.answer(*checkpoint, checkpoint_line(*checkpoint));
}

absl::StatusOr<ExitCode> list(Application& application, const Options& options) {
  v1::ListCheckpointsRequest request;
  request.set_parent(full_name("simulations", options.name));
  const auto all =
      list_all<SimulationService>(application.connect(), &Stub::ListCheckpoints, request,
                                  [](v1::ListCheckpointsResponse& response) { return response.mutable_checkpoints(); });
  if (!all.ok()) return all.status();
  std::string text;
  for (const v1::Checkpoint& checkpoint : all->checkpoints()) text += checkpoint_line(checkpoint);
  text += unreachable_lines(*all);
  return application.answer(*all, text);
}

absl::StatusOr<ExitCode> remove(Application& application, const Options& options) {
  v1::DeleteCheckpointRequest request;
  request.set_name(options.name);
  const auto deleted = application.connect().call<SimulationService>(&Stub::DeleteCheckpoint, request);
  if (!deleted.ok()) return deleted.status();
  return application.done(absl::StrCat("deleted ", request.name()));
}

absl::StatusOr<ExitCode> restore(Application& application, const Options& options) {
  v1::RestoreSimulationRequest request;
  request.set_checkpoint(options.name);
  request.set_request_id(options.request_id);
  request.set_as_new(options.as_new);
  request.set_simulation_id(options.id);
  request.set_display_name(options.display_name);
  request.set_start(options.start);
  const auto simulation =
      application.connect().call<SimulationService>(&Stub::RestoreSimulation, request, Connection::kCreationTimeout);
  if (!simulation.ok()) return simulation.status();
  return application.answer(*simulation, summary_text(simulation->name(), *simulation));
}

void add_request_id(CLI::App& command, const std::shared_ptr<Options>& options) {
  command.add_option("--request-id", options->request_id, "a repeated call with the same one is carried out once");
}

void add_restoring(CLI::App& group, Application& application, const std::shared_ptr<Options>& options) {
  CLI::App* command =
      add_command(group, application, "restore", "Take a simulation back to a checkpoint, or begin a new one from it",
                  "  lipofill simulation restore simulations/abc/checkpoints/before\n"
                  "  lipofill simulation restore simulations/abc/checkpoints/before --new --id abc-more --start\n",
                  [&application, options] { return restore(application, *options); });
  command->add_option("checkpoint", options->name, "simulations/ID/checkpoints/ID")->required();
  CLI::Option* as_new = command->add_flag("--new", options->as_new, "begin a new simulation in place of going back");
  command->add_option("--id", options->id, "the last part of its name; made up when absent")->needs(as_new);
  command->add_option("--display-name", options->display_name, "for dashboards")->needs(as_new);
  command->add_flag("--start", options->start, "start it at once")->needs(as_new);
  add_request_id(*command, options);
}

}  // namespace

void add_checkpoint_commands(CLI::App& group, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* made = add_command(group, application, "checkpoint", "Keep the state it is in",
                               "  lipofill simulation checkpoint abc --id before\n",
                               [&application, options] { return keep(application, *options); });
  made->add_option("simulation", options->name, "simulations/ID, or the ID alone")->required();
  made->add_option("--id", options->id, "the last part of the checkpoint's name; made up when absent");
  add_request_id(*made, options);
  add_command(group, application, "checkpoints", "List the states that are kept of it",
              "  lipofill simulation checkpoints abc --json\n",
              [&application, options] { return list(application, *options); })
      ->add_option("simulation", options->name, "simulations/ID, or the ID alone")
      ->required();
  add_command(group, application, "forget", "Delete a checkpoint",
              "  lipofill simulation forget simulations/abc/checkpoints/before\n",
              [&application, options] { return remove(application, *options); })
      ->add_option("checkpoint", options->name, "simulations/ID/checkpoints/ID")
      ->required();
  add_restoring(group, application, options);
}

}  // namespace lipofill::client
