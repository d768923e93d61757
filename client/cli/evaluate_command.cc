#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/application.h"
#include "client/cli/describe.h"
#include "client/cli/options.h"
#include "client/cli/private_daemon.h"
#include "client/cli/result_files.h"
#include "client/cli/run_record.h"
#include "client/cli/simulation_calls.h"
#include "client/cli/units.h"
#include "client/cpp/json_file.h"
#include "client/cpp/requirement.h"

namespace lipofill::client {
namespace {

struct Options {
  std::string result;
  std::string target;
  std::string out;
  v1::ScanUnit unit = v1::MILLIMETRE;
  std::vector<std::string> required;
};

bool is_folder(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error);
}

/// The folder that drawing needs to know the simulation's place and upright.
absl::Status prepare_folder(const std::filesystem::path& folder, const RunRecord& record) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    return absl::InvalidArgumentError(absl::StrCat("cannot make the folder ", folder.string(), ": ", error.message()));
  if (std::filesystem::exists(folder / "run.json", error)) return absl::OkStatus();
  return write_run_record(folder, record);
}

/// Tells of the requirements that are missed.
ExitCode check_required(const std::vector<Requirement>& required, const v1::Evaluation& evaluation) {
  ExitCode code = ExitCode::kOk;
  for (const Requirement& requirement : required) {
    const double figure = requirement.figure_of(evaluation);
    if (requirement.is_met(figure)) continue;
    std::cerr << "lipofill: required " << requirement.text << ", it is " << figure << "\n";
    code = ExitCode::kGoalNotReached;
  }
  return code;
}

absl::StatusOr<ExitCode> evaluate_on(Application& application, const Connection& connection, const std::string& name,
                                     const Options& options, const std::filesystem::path& out) {
  const auto required = read_requirements(options.required);
  if (!required.ok()) return required.status();
  const auto simulation = get_simulation(connection, name);
  if (!simulation.ok()) return simulation.status();
  const auto record = record_of_simulation(connection, *simulation);
  if (!record.ok()) return record.status();
  if (auto status = prepare_folder(out, *record); !status.ok()) return status;
  absl::Status picture_problem;
  const auto evaluation = evaluate_into(out, connection, *simulation, options.target, options.unit, &picture_problem);
  if (!evaluation.ok()) return evaluation.status();
  if (!picture_problem.ok()) std::cerr << "lipofill: no distance.png: " << picture_problem.message() << "\n";
  if (application.json) {
    std::cout << read_text_file(out / "evaluation.json").value_or("");
  } else {
    std::cout << describe(*evaluation);
  }
  return check_required(*required, *evaluation);
}

/// A folder knows its simulation: on the daemon that ran it, or in the state a private one left in
/// the folder.
absl::StatusOr<ExitCode> evaluate_folder(Application& application, const Options& options) {
  const std::filesystem::path folder = options.result;
  const std::filesystem::path out = options.out.empty() ? folder : std::filesystem::path(options.out);
  const auto record = read_run_record(folder);
  if (!record.ok()) return record.status();
  if (!record->kept) {
    return absl::FailedPreconditionError(
        absl::StrCat("the run in ", options.result, " did not keep its simulation (--discard)"));
  }
  if (record->data.empty()) {
    return evaluate_on(application, application.connect_to(record->server), record->simulation, options, out);
  }
  const auto daemon = PrivateDaemon::start(folder / record->data, application.interrupt().token());
  if (!daemon.ok()) return daemon.status();
  return evaluate_on(application, application.connect_to((*daemon)->server()), record->simulation, options, out);
}

absl::StatusOr<ExitCode> evaluate(Application& application, const Options& options) {
  if (is_folder(options.result)) return evaluate_folder(application, options);
  if (options.out.empty()) return absl::InvalidArgumentError("--out is needed for a simulation on the daemon");
  return evaluate_on(application, application.connect(), options.result, options, options.out);
}

}  // namespace

void add_evaluate_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_command(root, application, "evaluate",
                                  "Distance of the simulated skin to a target surface in the same frame, both "
                                  "directions, inside the region: writes "
                                  "evaluation.json, distance.vtp and distance.png",
                                  "  lipofill evaluate result --target goal.obj\n  lipofill evaluate simulations/abc "
                                  "--target goal.obj --out result\n  lipofill evaluate result --target goal.obj "
                                  "--require 'p95_mm<=2' --require 'volume_simulated.deficit_ml<=0.5'\n",
                                  [&application, options] { return evaluate(application, *options); });
  command->add_option("result", options->result, "a folder that lipofill run wrote, or simulations/ID")->required();
  command->add_option("--target", options->target, ".obj, .ply or .stl, or patients/ID/scans/ID")->required();
  command->add_option("--out", options->out, "folder; default: the folder of results");
  command->add_option("--require", options->required,
                      "FIGURE<=NUMBER or FIGURE>=NUMBER, as \"p95_mm<=2\": exit code 1 where it is missed. FIGURE is a "
                      "name of evaluation.json; one of statistics is from the simulated skin to the target, others as "
                      "\"target_to_simulated.max_mm\", \"volume_simulated.deficit_ml\", "
                      "\"zones.ZONE.simulated.skin_to_target.p95_mm\"; may be repeated");
  command->add_option("--unit", options->unit, "unit of the target's numbers: mm (default), cm or m")
      ->transform(choice_of(kUnitNames));
}

}  // namespace lipofill::client
