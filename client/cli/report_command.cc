#include <memory>

#include "client/cli/application.h"
#include "client/cli/forecast_command.h"
#include "client/cli/options.h"
#include "client/cli/report_run.h"
#include "client/cli/units.h"
#include "client/cpp/report/command_again.h"

namespace lipofill::client {
namespace {

constexpr char kDescription[] =
    "Make a report of a plan to read and to print: the face before, planned, after twelve months and as the target, "
    "from five sides; maps of movement, pressure and distance; mL to prepare, to inject and to keep by zone, plane and "
    "session; pressure bands; the delivery list; intervals and what drives them; tissue with its sources; hashes and "
    "the line that makes it again. Writes into the folder: report.html, one file for any browser; report.pdf, the same "
    "printed (needs Chromium); report.csv and report.json, the same figures. What was not asked for is said in it. "
    "Equal inputs with an equal --date give equal bytes, but for the PDF. The patient goes by a pseudonym: give no "
    "file "
    "a name that says more. Progress goes to the error output; Ctrl-C cancels.";

constexpr char kExamples[] =
    "  lipofill report jaw_angle.json --out report --spawn\n"
    "  lipofill report jaw_angle.json --out report --spawn --healthy right --pseudonym case-7\n"
    "  lipofill report jaw_angle.json --out report --spawn --target goal.obj --members 1000 --retention centrifuge\n"
    "  lipofill report jaw_angle.json --out bericht --spawn --language de --paper a4 --date 2026-11-30\n"
    "  lipofill report jaw_angle.json --out report --spawn --no-forecast --no-pdf     in seconds, without intervals\n"
    "  lipofill report jaw_angle.json --out report --spawn --json > figures.json      the record, for programs\n";

void add_target_options(CLI::App& command, ReportOptions& options) {
  command
      .add_option("--target", options.target,
                  "the face as it should be: .obj, .ply or .stl, or patients/ID/scans/ID; default: no target")
      ->type_name("SURFACE");
  command.add_option("--target-unit", options.target_unit, "unit of the target's numbers: mm (default), cm or m")
      ->transform(choice_of(kUnitNames));
  command.add_option("--target-landmarks", options.target_landmarks,
                     "landmarks of the target; it is registered by them");
  command.add_flag("--in-place", options.in_place, "the target lies where it belongs: check it, do not move it");
  command.add_option("--healthy", options.healthy, "mirror this side, the subject's own, for a target: left or right")
      ->check(CLI::IsMember({"left", "right"}));
}

void add_page_options(CLI::App& command, ReportOptions& options) {
  command.add_option("--pseudonym", options.pseudonym,
                     "what the patient is called in it; default: the display name of --patient");
  command.add_option("--date", options.date, "the day on the report, YYYY-MM-DD; default: today");
  command.add_option("--language", options.language, "of the report: en (default) or de")
      ->check(CLI::IsMember({"en", "de"}));
  command
      .add_option_function<std::string>(
          "--paper",
          [&options](const std::string& paper) { options.paper = paper == "a4" ? Paper::kA4 : Paper::kLetter; },
          "a4 (default) or letter")
      ->check(CLI::IsMember({"a4", "letter"}));
  command.add_option("--reserve-percent", options.reserve_percent,
                     "fat to prepare beyond what is injected, for syringes and cannulas (default 10, assumed)");
  command.add_flag("--no-pdf", options.no_pdf, "do not print it");
}

}  // namespace

void add_report_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<ReportOptions>();
  CLI::App* command = add_command(root, application, "report", kDescription, kExamples, [&application, options] {
    if (options->date.empty()) options->date = today();
    options->command = command_again(application.words, options->date);
    return ReportRun(application, *options).carry_out();
  });
  add_plan_work_options(*command, *options);
  add_target_options(*command, *options);
  add_page_options(*command, *options);
  command->add_flag("--no-forecast", options->no_forecast,
                    "no cases of other tissue: figures without intervals, in a fraction of the time");
  command->add_option("--settings", options->settings, "a JSON file with a ForecastSpec: inputs and the rest");
  add_forecast_options(*command, [options] { return &options->spec; });
}

}  // namespace lipofill::client
