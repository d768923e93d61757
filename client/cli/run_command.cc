#include <memory>

#include "client/cli/application.h"
#include "client/cli/face_run.h"
#include "client/cli/options.h"
#include "client/cli/run.h"
#include "client/cli/units.h"

namespace lipofill::client {
namespace {

constexpr char kDescription[] =
    "Carry out a plan from scan to result. Writes into the folder: skin_NNNN.vtp, film_NNNN.vtp, tissue_NNNN.vtu and "
    "(with a scan) "
    "scan_NNNN.vtp at the interval and at the end, .pvd files that ParaView opens, series.csv, summary.json, "
    "picture.png, run.json. "
    "A plan of several parts of the face leaves a folder a part and the whole face beside them. "
    "Progress goes to the error output, the summary to the standard output. Ctrl-C stops the simulation.";

constexpr char kRunExamples[] =
    "  lipofill run jaw_angle.json --out result --spawn\n"
    "  lipofill run jaw_angle.json --out result --spawn --fast\n"
    "  lipofill run jaw_angle.json --out result --spawn --preview\n"
    "  lipofill run jaw_angle.json --out result --spawn --scan face.obj --landmarks face.json --unit mm\n"
    "  lipofill run jaw_angle.json --out result --spawn --interval-ms 500 --evaluate goal.obj\n"
    "  lipofill run several_parts.json --out result --spawn --fast\n"
    "  lipofill run square.json --out result --server 10.0.0.5:50061 --json --quiet\n";

}  // namespace

void add_run_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<RunOptions>();
  CLI::App* command = add_command(root, application, "run", kDescription, kRunExamples, [&application, options] {
    return has_parts(options->plan) ? FaceRun(application, *options).carry_out()
                                    : Run(application, *options).carry_out();
  });
  command->add_option("plan", options->plan, "PLAN.json")->required();
  command->add_option("--out", options->out, "folder of results; made when missing")->required();
  add_ground_options(*command, *options,
                     "start a private lipofilld for this run and stop it after; its state stays in OUT/.lipofilld");
  command
      ->add_option("--interval-ms", options->interval_ms,
                   "simulated time between written files, in place of the plan's; 0: only first and last")
      ->check(CLI::NonNegativeNumber);
  command->add_flag(
      "--fast", options->fast,
      "only the settled shape counts: it is found directly, or where the plan forbids that in few long steps "
      "(time.goal SETTLED_SHAPE with its own max_step_ms, max_injection_step_ms and error_tolerance_mm)");
  command->add_flag("--preview", options->preview,
                    "first the settled shape of a coarse model, told as soon as it is there and written to "
                    "skin_preview.vtp and scan_preview.vtp; in the end, how far it was from the result");
  command->add_option("--evaluate", options->evaluate,
                      "measure the result against this surface, as lipofill evaluate does");
  command->add_option("--target-unit", options->target_unit, "unit of that surface: mm (default), cm or m")
      ->transform(choice_of(kUnitNames));
  command->add_flag(
      "--keep,!--discard", options->keep,
      "keep patient, model and simulation where they ran (the default), or delete them once the files are written");
  command->add_flag("!--no-picture", options->picture, "do not draw picture.png");
  command->add_flag("--quiet", options->quiet, "no progress, no summary");
}

}  // namespace lipofill::client
