#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/cli/application.h"
#include "client/cli/describe.h"
#include "client/cli/listing.h"
#include "client/cli/simulation_calls.h"
#include "client/cpp/plan_file.h"
#include "client/cpp/result_text.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {
namespace {

using v1::SimulationService;
using Stub = SimulationService::Stub;

struct Options {
  std::string name;
  std::string plan;
  std::string model;
  std::string id;
  std::string display_name;
  std::string request_id;
  bool start = false;
  uint64_t after_step = 0;
  std::string zone;
  double volume_ml = 0.0;
  double rate_ml_per_s = 0.0;
  std::optional<double> start_s;
};

ExitCode answer(const Application& application, const v1::Simulation& simulation) {
  const std::string title = simulation.display_name().empty()
                                ? simulation.name()
                                : absl::StrCat(simulation.name(), " ", simulation.display_name());
  return application.answer(simulation, summary_text(title, simulation));
}

absl::StatusOr<ExitCode> create(Application& application, const Options& options) {
  const auto plan = load_plan(options.plan);
  if (!plan.ok()) return plan.status();
  v1::CreateSimulationRequest request;
  request.set_request_id(options.request_id);
  request.set_simulation_id(options.id);
  request.set_display_name(options.display_name.empty() ? display_name_of(plan->plan.name()) : options.display_name);
  *request.mutable_spec() = plan->plan.simulation();
  request.mutable_spec()->set_model(options.model);
  request.set_start(options.start);
  const auto simulation =
      application.connect().call<SimulationService>(&Stub::CreateSimulation, request, Connection::kCreationTimeout);
  if (!simulation.ok()) return simulation.status();
  return answer(application, *simulation);
}

/// Calls that take a name and give the simulation as it is then.
template <typename Request>
absl::StatusOr<ExitCode> steer(Application& application, const Options& options,
                               grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, v1::Simulation*)) {
  Request request;
  request.set_name(full_name("simulations", options.name));
  const auto simulation = application.connect().call<SimulationService>(method, request);
  if (!simulation.ok()) return simulation.status();
  return answer(application, *simulation);
}

absl::StatusOr<ExitCode> list(Application& application) {
  const auto all =
      list_all<SimulationService>(application.connect(), &Stub::ListSimulations, v1::ListSimulationsRequest(),
                                  [](v1::ListSimulationsResponse& response) { return response.mutable_simulations(); });
  if (!all.ok()) return all.status();
  std::string text;
  for (const v1::Simulation& simulation : all->simulations()) text += list_line(simulation);
  text += unreachable_lines(*all);
  return application.answer(*all, text);
}

absl::StatusOr<ExitCode> remove(Application& application, const Options& options) {
  v1::DeleteSimulationRequest request;
  request.set_name(full_name("simulations", options.name));
  const auto deleted = application.connect().call<SimulationService>(&Stub::DeleteSimulation, request);
  if (!deleted.ok()) return deleted.status();
  return application.done(absl::StrCat("deleted ", request.name()));
}

absl::StatusOr<ExitCode> inject(Application& application, const Options& options) {
  v1::InjectRequest request;
  request.set_name(full_name("simulations", options.name));
  v1::Injection* injection = request.mutable_injection();
  injection->set_zone(options.zone);
  injection->set_volume_ml(options.volume_ml);
  injection->set_rate_ml_per_s(options.rate_ml_per_s);
  if (options.start_s) injection->set_start_s(*options.start_s);
  request.set_request_id(options.request_id);
  const auto simulation = application.connect().call<SimulationService>(&Stub::Inject, request);
  if (!simulation.ok()) return simulation.status();
  return answer(application, *simulation);
}

absl::StatusOr<ExitCode> series(Application& application, const Options& options) {
  const Connection connection = application.connect();
  const auto simulation = get_simulation(connection, options.name);
  if (!simulation.ok()) return simulation.status();
  std::vector<v1::SeriesRow> rows;
  if (options.after_step > 0) rows.emplace_back().set_step(options.after_step);
  if (auto status = fetch_series(connection, simulation->name(), &rows); !status.ok()) return status;
  if (options.after_step > 0) rows.erase(rows.begin());
  v1::GetSeriesResponse response;
  response.mutable_rows()->Assign(rows.begin(), rows.end());
  return application.answer(response, series_csv(simulation->spec(), rows));
}

void add_creation(CLI::App& group, Application& application, const std::shared_ptr<Options>& options) {
  CLI::App* command =
      add_command(group, application, "create", "Create the simulation of a plan on a model",
                  "  lipofill simulation create jaw_angle.json --model patients/case-7/models/abc --start\n",
                  [&application, options] { return create(application, *options); });
  command->add_option("plan", options->plan, "PLAN.json")->required();
  command->add_option("--model", options->model, "patients/ID/models/ID")->required();
  command->add_option("--id", options->id, "the last part of its name; made up when absent");
  command->add_option("--display-name", options->display_name, "for dashboards; default: the plan's name");
  command->add_option("--request-id", options->request_id,
                      "a repeated call with the same one gives the same simulation");
  command->add_flag("--start", options->start, "start it at once");
}

void add_injection(CLI::App& group, Application& application, const std::shared_ptr<Options>& options) {
  CLI::App* command =
      add_command(group, application, "inject",
                  "Add an injection to a simulation that has not ended, or that has settled: it then goes on",
                  "  lipofill simulation inject abc --zone masseter --volume-ml 1.5 --rate-ml-per-s 0.5\n",
                  [&application, options] { return inject(application, *options); });
  command->add_option("simulation", options->name, "simulations/ID, or the ID alone")->required();
  command->add_option("--zone", options->zone, "zone of a film")->required();
  command->add_option("--volume-ml", options->volume_ml, "negative: taken out")->required();
  command->add_option("--rate-ml-per-s", options->rate_ml_per_s, "how fast")->required();
  command->add_option("--start-s", options->start_s, "simulated time; default: now, or after those already due");
  command->add_option("--request-id", options->request_id, "a repeated call with the same one is carried out once");
}

}  // namespace

void add_simulation_commands(CLI::App& root, Application& application) {
  CLI::App* group = add_group(root, "simulation", "Simulations on the daemon");
  const auto options = std::make_shared<Options>();
  const auto add_named = [&](const std::string& word, const char* description, auto action) {
    CLI::App* command =
        add_command(*group, application, word, description, absl::StrCat("  lipofill simulation ", word, " abc\n"),
                    [&application, options, action] { return action(application, *options); });
    command->add_option("simulation", options->name, "simulations/ID, or the ID alone")->required();
    return command;
  };
  const auto steering = [](auto method) {
    return [method](Application& app, const Options& chosen) { return steer(app, chosen, method); };
  };
  add_creation(*group, application, options);
  add_named("start", "Start it", steering(&Stub::StartSimulation));
  add_named("pause", "Hold it after the step it is in", steering(&Stub::PauseSimulation));
  add_named("resume", "Let a paused one go on", steering(&Stub::ResumeSimulation));
  add_named("stop", "End it, keeping what it reached", steering(&Stub::StopSimulation));
  add_injection(*group, application, options);
  add_named("get", "Show its state and figures", steering(&Stub::GetSimulation));
  add_command(*group, application, "list", "List all simulations", "  lipofill simulation list --json\n",
              [&application] { return list(application); });
  add_named("delete", "Delete it; one that runs is stopped first", remove);
  add_checkpoint_commands(*group, application);
  add_named("series", "Its time series as CSV", series)
      ->add_option("--after-step", options->after_step, "only rows after this step");
}

}  // namespace lipofill::client
