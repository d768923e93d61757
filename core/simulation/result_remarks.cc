// This file says what to know before relying on a result.

#include <cmath>

#include "absl/strings/str_format.h"
#include "core/base/units.h"
#include "core/simulation/simulation_impl.h"

namespace lipofill::simulation {
namespace {

constexpr double kPoorScaledJacobian = 0.2;
constexpr double kHighPressure = 10e3;     // [Pa]
constexpr double kLargeVolumeLoss = 0.02;  // of the tissue
constexpr double kSmallRest = 0.01;        // of the lift
constexpr double kPascalsPerMmhg = 133.322;

/// Says why a plan that ended after its injections is not at rest: too early, or because the skin
/// goes to and fro, as over stiff deep planes.
void remark_on_unrest(const StepReport& report, plan::TimeGoal goal, std::vector<std::string>& remarks) {
  const double left = report.settling_error;
  if (std::isfinite(left)) {
    if (left <= kSmallRest * report.skin_max_displacement) return;
    remarks.push_back(
        absl::StrFormat("The skin has some %.3f mm still to go at the end, %.1f %% of its lift: raise end_s.",
                        left * kMillimetresPerMetre, 100.0 * left / report.skin_max_displacement));
    return;
  }
  remarks.push_back(absl::StrFormat(
      "The skin does not come to rest: at the end its speed, %.3g mm/s, has risen again, as where it goes to and fro "
      "over a stiff plane; %s.",
      report.skin_speed * kMillimetresPerMetre,
      goal == plan::TimeGoal::kSettledShape
          ? "Summary.way says what keeps its settled shape from being solved for directly"
          : "time.goal SETTLED_SHAPE solves for its settled shape in place of stepping to it"));
}

}  // namespace

/// The remarks on the shape it ended in.
void Simulation::Impl::remark_on_result(std::vector<std::string>& remarks) const {
  if (report.max_pressure > kHighPressure) {
    remarks.push_back(
        absl::StrFormat("The fat presses with %.1f kPa (%.0f mmHg) at most; above %.0f kPa no tissue "
                        "holds it where it is put: inject less or into a larger zone.",
                        report.max_pressure / kPascalsPerKilopascal, report.max_pressure / kPascalsPerMmhg,
                        kHighPressure / kPascalsPerKilopascal));
  }
  const double lift = report.skin_max_displacement;
  if (phase == Phase::kSettled && report.settling_error > kSmallRest * lift && std::isfinite(report.settling_error)) {
    remarks.push_back(
        absl::StrFormat("The skin is slow enough to count as at rest and has some %.3f mm still to go, "
                        "%.1f %% of its lift: lower settle_skin_speed_mm_per_s to go on.",
                        report.settling_error * kMillimetresPerMetre, 100.0 * report.settling_error / lift));
  }
  if (phase == Phase::kFinished && spec.settle_skin_speed > 0.0 && state.time >= schedule.end()) {
    remark_on_unrest(report, spec.goal, remarks);
  }
  if (stepper->tissue() == nullptr) return;
  if (report.min_scaled_jacobian < kPoorScaledJacobian) {
    remarks.push_back(
        absl::StrFormat("The tissue is distorted: the worst hexahedron has a scaled Jacobian of %.2f, "
                        "below %.1f its figures are not to be relied upon.",
                        report.min_scaled_jacobian, kPoorScaledJacobian));
  }
  double before = 0.0, change = 0.0;
  for (const LayerReport& layer : report_layers()) {
    before += layer.rest_volume;
    change += layer.volume - layer.rest_volume;
  }
  if (std::abs(change) <= kLargeVolumeLoss * before) return;
  remarks.push_back(
      absl::StrFormat("The tissue %s %.1f %% of its volume (%.2f mL), which soft tissue keeps to %.0f %%.",
                      change < 0.0 ? "lost" : "gained", 100.0 * std::abs(change) / before,
                      std::abs(change) * kMillilitresPerCubicMetre, 100.0 * kLargeVolumeLoss));
}

std::vector<std::string> Simulation::remarks() const {
  std::vector<std::string> remarks = impl_->model->geometry.cautions;
  for (const plan::FilmLayout& film : impl_->films) {
    remarks.insert(remarks.end(), film.remarks.begin(), film.remarks.end());
  }
  if (impl_->phase != Phase::kRunning) impl_->remark_on_result(remarks);
  return remarks;
}

}  // namespace lipofill::simulation
