#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "client/cli/application.h"
#include "client/cli/describe.h"
#include "client/cpp/errors.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/plan_file.h"
#include "client/cpp/scan_upload.h"
#include "lipofill/v1/simulation_service.grpc.pb.h"

namespace lipofill::client {
namespace {

/// Checks everything that needs no daemon: the JSON, the fields, the files it names.
absl::Status check_files(PlanFile* plan) {
  if (plan->plan.model().has_scan_region() && !plan->scan_file && plan->plan.model().scan_region().scan().empty()) {
    return invalid_fields(
        "no scan",
        {{"scan.file", absl::StrCat("is missing: model.scan_region cuts a scan (in ", plan->path.string(), ")")}});
  }
  if (plan->scan_file) {
    if (const auto hash = sha256_of_file(*plan->scan_file); !hash.ok()) return hash.status();
    if (const auto format = scan_format_of(*plan->scan_file); !format.ok()) return format.status();
  }
  return load_plan_landmarks(plan);
}

ExitCode tell_of_files(const Application& application, const std::string& file, const v1::Plan& plan) {
  const v1::SimulationSpec& simulation = plan.simulation();
  if (application.json) {
    std::cout << nlohmann::ordered_json{{"plan", plan.name()},
                                        {"layers", plan.model().layers_size()},
                                        {"films", simulation.films_size()},
                                        {"injections", simulation.injections_size()},
                                        {"parts", plan.parts_size()},
                                        {"landmarks", plan.model().scan_region().landmarks_mm().size()}}
                     .dump(2)
              << "\n";
  } else {
    const std::string parts = plan.parts_size() > 0 ? absl::StrCat(" and ", plan.parts_size(), " parts, each") : "";
    std::cout << absl::StrCat(file, ": a plan", parts, " with ", plan.model().layers_size(), " layers, ",
                              simulation.films_size(), " films and ", simulation.injections_size(),
                              " injections; values are checked by the daemon, with --model or when it runs\n");
  }
  return ExitCode::kOk;
}

/// Asks the daemon what it has to say of the plan on a model; nothing is made.
absl::StatusOr<ExitCode> check_on_model(Application& application, const v1::Plan& plan, const std::string& model) {
  if (auto read = application.read_credentials(); !read.ok()) return read;
  v1::CheckPlanRequest request;
  *request.mutable_spec() = plan.simulation();
  request.mutable_spec()->set_model(model);
  const auto found = application.connect().call<v1::SimulationService>(&v1::SimulationService::Stub::CheckPlan, request,
                                                                       Connection::kCreationTimeout);
  if (!found.ok()) return found.status();
  application.answer(*found, describe(*found));
  return found->violations().empty() ? ExitCode::kOk : ExitCode::kBadInput;
}

absl::StatusOr<ExitCode> check(Application& application, const std::string& file, const std::string& model) {
  auto plan = load_plan(file);
  if (!plan.ok()) return plan.status();
  if (auto status = check_files(&*plan); !status.ok()) return status;
  return model.empty() ? tell_of_files(application, file, plan->plan) : check_on_model(application, plan->plan, model);
}

}  // namespace

void add_plan_commands(CLI::App& root, Application& application) {
  CLI::App* group = add_group(root, "plan", "Plans: files, and those that are kept with a patient");
  const auto file = std::make_shared<std::string>();
  const auto model = std::make_shared<std::string>();
  CLI::App* command = add_local_command(
      *group, application, "check",
      "Check a plan's JSON, its fields and the files it names, without a daemon. With --model also what the daemon has "
      "against it on that model, where its zones are, and what is worth knowing; no simulation is made",
      "  lipofill plan check jaw_angle.json\n"
      "  lipofill plan check jaw_angle.json --model patients/case-7/models/abc\n",
      [&application, file, model] { return check(application, *file, *model); });
  command->add_option("plan", *file, "PLAN.json")->required();
  command->add_option("--model", *model, "patients/ID/models/ID");
  add_connection_options(*command, application);
  add_saved_plan_commands(*group, application);
}

}  // namespace lipofill::client
