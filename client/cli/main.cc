// lipofill: the command line of the planner. Each command fills in an action; this file carries it
// out and turns what came of it into an exit code.

#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/application.h"
#include "client/cli/forecast_command.h"
#include "client/cli/records_command.h"
#include "client/cli/scene_command.h"
#include "client/cli/thickness_command.h"
#include "client/cpp/errors.h"
#include "client/cpp/nearest_name.h"
#include "client/cpp/result_text.h"

namespace lipofill::client {
namespace {

constexpr char kExamples[] =
    "Examples:\n"
    "  lipofill run jaw_angle.json --out result --spawn       simulate a plan, nothing else needed\n"
    "  lipofill run jaw_angle.json --out result               the same on the daemon at $LIPOFILL_SERVER\n"
    "  lipofill evaluate result --target goal.obj             how far the simulated skin is from a goal\n"
    "  lipofill propose jaw_angle.json --target goal.obj --out proposed --spawn    volumes that fill what is missing\n"
    "  lipofill report jaw_angle.json --out report --spawn    a page of all that is known of a plan, to print\n"
    "  lipofill scan extract head.nii.gz --out skin.ply       the skin in a CT\n"
    "  lipofill simulation list --json                        for scripts: every command has --json\n"
    "  lipofill COMMAND --help                                examples of each command\n\n";

void add_all_commands(CLI::App& root, Application& application) {
  add_run_command(root, application);
  add_plan_commands(root, application);
  add_patient_commands(root, application);
  add_scan_commands(root, application);
  add_model_commands(root, application);
  add_simulation_commands(root, application);
  add_watch_command(root, application);
  add_export_command(root, application);
  add_evaluate_command(root, application);
  add_propose_command(root, application);
  add_thickness_command(root, application);
  add_deliver_command(root, application);
  add_forecast_commands(root, application);
  add_report_command(root, application);
  add_shape_command(root, application);
  add_target_command(root, application);
  add_render_command(root, application);
  add_records_commands(root, application);
  add_scene_command(root, application);
  add_operation_commands(root, application);
  add_health_command(root, application);
}

void print_error(const Application& application, const absl::Status& status) {
  if (application.json) {
    std::cerr << error_json(status) << "\n";
  } else {
    std::cerr << "lipofill: " << error_text(status) << "\n";
  }
}

/// Counts the words after an option that are its value.
int n_values(const CLI::App& app, const std::string& option) {
  const CLI::Option* known = app.get_option_no_throw(option);
  return known == nullptr ? 0 : known->get_items_expected_min();
}

/// Refuses a command line with a word for a command that there is not, and names the nearest one
/// there is.
absl::Status check_commands(const CLI::App& root, int argc, char** argv) {
  const CLI::App* app = &root;
  std::string path;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.starts_with("-")) {
      i += n_values(*app, word);
      continue;
    }
    std::vector<std::string> names;
    const CLI::App* named = nullptr;
    for (const CLI::App* command : app->get_subcommands({})) {
      names.push_back(command->get_name());
      if (command->get_name() == word) named = command;
    }
    if (names.empty()) return absl::OkStatus();
    if (named == nullptr) {
      const std::string nearest = find_nearest_name(word, names);
      const std::string hint = nearest.empty() ? "" : absl::StrCat(" (did you mean '", path, nearest, "'?)");
      return absl::InvalidArgumentError(
          absl::StrCat("there is no command '", path, word, "'", hint, "; see lipofill ", path, "--help"));
    }
    app = named;
    absl::StrAppend(&path, word, " ");
  }
  return absl::OkStatus();
}

/// A command line that does not parse, also as JSON when that was asked for.
int report_usage(const CLI::App& root, const CLI::ParseError& error, const Application& application) {
  if (error.get_exit_code() == 0) return root.exit(error);  // --help
  if (application.json) {
    print_error(application, absl::InvalidArgumentError(error.what()));
  } else {
    root.exit(error);
  }
  return static_cast<int>(ExitCode::kBadInput);
}

ExitCode carry_out(Application& application) {
  const absl::StatusOr<ExitCode> result = application.action();
  if (result.ok()) return *result;
  if (absl::IsCancelled(result.status())) {
    print_error(application, absl::CancelledError("interrupted"));
  } else {
    print_error(application, result.status());
  }
  return exit_code_of(result.status());
}

int run(int argc, char** argv) {
  Application application;
  application.words.assign(argv + 1, argv + argc);
  CLI::App root(
      "Plans facial fat grafting: sends plans to a lipofilld, watches, measures and draws what comes of them.",
      "lipofill");
  root.set_version_flag("--version", std::string("lipofill ") + LIPOFILL_VERSION);
  root.require_subcommand(1);
  root.footer(std::string(kExamples) + kExitCodeHelp + "\n" + kNotAMedicalDevice);
  add_all_commands(root, application);
  try {
    root.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    for (int i = 1; i < argc; ++i) application.json = application.json || std::string_view(argv[i]) == "--json";
    if (const absl::Status known = check_commands(root, argc, argv); error.get_exit_code() != 0 && !known.ok()) {
      print_error(application, known);
      return static_cast<int>(ExitCode::kBadInput);
    }
    return report_usage(root, error, application);
  }
  return static_cast<int>(carry_out(application));
}

}  // namespace
}  // namespace lipofill::client

int main(int argc, char** argv) {
  try {
    return lipofill::client::run(argc, argv);
  } catch (const std::exception& exception) {
    std::cerr << "lipofill: " << exception.what() << "\n";
    return static_cast<int>(lipofill::client::ExitCode::kInternal);
  }
}
