#include <memory>

#include "client/cli/application.h"
#include "client/cli/options.h"
#include "client/cli/propose_run.h"
#include "client/cli/units.h"

namespace lipofill::client {
namespace {

constexpr char kDescription[] =
    "Propose a plan that brings the skin near a target surface in the frame of the scan: the volumes of the plan's "
    "zones, and with --zones the zones too, within bounds. Writes into the folder: plan.json, which lipofill run "
    "takes, and proposal.json with what is reached, what is left and why, and the curve of closeness against volume "
    "and pressure. Progress goes to the error output. Ctrl-C cancels.";

constexpr char kExamples[] =
    "  lipofill propose jaw_angle.json --target goal.obj --out proposed --spawn\n"
    "  lipofill propose jaw_angle.json --target goal.obj --out proposed --spawn --max-total-ml 5 --max-pressure-pa "
    "2000\n"
    "  lipofill propose cheek.json --target goal.obj --out proposed --spawn --zones --below subcutaneous\n"
    "  lipofill propose jaw_angle.json --target goal.obj --out proposed --spawn --band-pa 2500\n"
    "  lipofill run proposed/plan.json --out result --spawn --evaluate goal.obj\n";

void add_bounds(CLI::App& command, const std::shared_ptr<ProposeOptions>& options) {
  const auto bounds = [options] { return options->spec.mutable_bounds(); };
  add_field<double>(command, "--min-zone-ml", "each zone takes at least this",
                    [bounds](double value) { bounds()->set_min_zone_ml(value); });
  add_field<double>(command, "--max-zone-ml", "each zone takes at most this",
                    [bounds](double value) { bounds()->set_max_zone_ml(value); });
  add_field<double>(command, "--max-total-ml", "all zones together take at most this",
                    [bounds](double value) { bounds()->set_max_total_ml(value); });
  add_field<double>(command, "--max-pressure-pa", "pressure of the fat at rest, in every zone",
                    [bounds](double value) { bounds()->set_max_pressure_pa(value); });
  add_field<double>(command, "--max-lift-mm", "the skin moves no farther than this, anywhere",
                    [bounds](double value) { bounds()->set_max_lift_mm(value); });
}

void add_choices(CLI::App& command, const std::shared_ptr<ProposeOptions>& options) {
  const auto zones = [options] { return options->spec.mutable_zones(); };
  command.add_flag_function(
      "--zones", [zones](int64_t) { zones(); }, "propose zones around what is missing, beside those of the plan");
  add_field<std::vector<std::string>>(command, "--below", "a layer below which proposed zones may lie; may be repeated",
                                      [zones](const std::vector<std::string>& layers) {
                                        zones()->mutable_below_layers()->Assign(layers.begin(), layers.end());
                                      });
  add_field<uint32_t>(command, "--max-zones", "propose at most so many zones (default 4)",
                      [zones](uint32_t value) { zones()->set_max_zones(value); });
  add_field<double>(command, "--min-deficit-mm", "propose no zone where less than this is missing (default 1)",
                    [zones](double value) { zones()->set_min_deficit_mm(value); });
  add_field<double>(command, "--worthwhile-mm",
                    "leave out zones that bring the skin less than this nearer (default 0.05)",
                    [options](double value) { options->spec.set_worthwhile_mm(value); });
  add_field<uint32_t>(command, "--curve-points", "points of the curve (default 5)",
                      [options](uint32_t value) { options->spec.set_curve_points(value); });
  add_field<double>(command, "--band-pa",
                    "the pressure stays below this in 95 of 100 cases of tissue that is softer or stiffer",
                    [options](double value) { options->spec.mutable_spread()->set_pressure_band_pa(value); });
}

}  // namespace

void add_propose_command(CLI::App& root, Application& application) {
  const auto options = std::make_shared<ProposeOptions>();
  CLI::App* command = add_command(root, application, "propose", kDescription, kExamples,
                                  [&application, options] { return ProposeRun(application, *options).carry_out(); });
  add_plan_work_options(*command, *options);
  command->add_option("--target", options->target, ".obj, .ply or .stl, or patients/ID/scans/ID")->required();
  command->add_option("--target-unit", options->target_unit, "unit of the target's numbers: mm (default), cm or m")
      ->transform(choice_of(kUnitNames));
  add_bounds(*command, options);
  add_choices(*command, options);
}

}  // namespace lipofill::client
