#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "client/cli/application.h"
#include "client/cpp/errors.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/plan_file.h"
#include "client/cpp/scan_upload.h"

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

absl::StatusOr<ExitCode> check(const Application& application, const std::string& file) {
  auto plan = load_plan(file);
  if (!plan.ok()) return plan.status();
  if (auto status = check_files(&*plan); !status.ok()) return status;
  const auto& simulation = plan->plan.simulation();
  if (application.json) {
    std::cout << nlohmann::ordered_json{{"plan", plan->plan.name()},
                                        {"layers", plan->plan.model().layers_size()},
                                        {"films", simulation.films_size()},
                                        {"injections", simulation.injections_size()},
                                        {"landmarks", plan->plan.model().scan_region().landmarks_mm().size()}}
                     .dump(2)
              << "\n";
  } else {
    std::cout << absl::StrCat(file, ": a plan with ", plan->plan.model().layers_size(), " layers, ",
                              simulation.films_size(), " films and ", simulation.injections_size(),
                              " injections; values are checked by the daemon when it runs\n");
  }
  return ExitCode::kOk;
}

}  // namespace

void add_plan_commands(CLI::App& root, Application& application) {
  CLI::App* group = add_group(root, "plan", "Plan files");
  const auto file = std::make_shared<std::string>();
  add_local_command(
      *group, application, "check", "Check a plan's JSON, its fields and the files it names, without a daemon",
      "  lipofill plan check jaw_angle.json\n", [&application, file] { return check(application, *file); })
      ->add_option("plan", *file, "PLAN.json")
      ->required();
}

}  // namespace lipofill::client
