#include "core/forecast/kept_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/forecast/sessions.h"
#include "core/simulation/trial_shape.h"

namespace lipofill::forecast {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using simulation::TrialShape;

/// Secant steps, and what they may leave of the volume.
constexpr int kMaxSecants = 6;
constexpr double kCloseness = 1e-3;
/// Shares that a follow-up is looked for between; the skin gains next to nothing below.
constexpr double kLeastShare = 0.02;
constexpr double kMostShare = 1.2;
/// Multiples of the plan's volumes that are tried.
constexpr double kMultiples[] = {0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0};

simulation::TrialVolumes scaled(const plan::SimulationSpec& plan, double multiple) {
  simulation::TrialVolumes volumes;
  for (size_t k = 0; k < plan.injections.size(); ++k) {
    volumes.injections.push_back({k, multiple * plan.injections[k].volume});
  }
  return volumes;
}

double total_volume(const plan::SimulationSpec& plan) {
  double total = 0.0;
  for (const plan::InjectionSpec& injection : plan.injections) total += injection.volume;
  return total;
}

absl::StatusOr<double> skin_volume(TrialShape& trial, const plan::SimulationSpec& plan, double share) {
  if (const absl::Status found = trial.find(scaled(plan, share), true); !found.ok()) return found;
  return trial.shape().report().skin_volume_change;
}

}  // namespace

absl::StatusOr<KeptShare> find_kept_share(const std::shared_ptr<const model::FaceModel>& model,
                                          const plan::SimulationSpec& plan, const FollowUp& found,
                                          const Retention& retention) {
  const double total = total_volume(plan);
  if (!found.is_skin_volume) return KeptShare{found.month, found.volume / total, found.standard_error / total};
  auto trial = TrialShape::create(model, plan);
  if (!trial.ok()) return trial.status();
  double before = 0.0, gained_before = 0.0, slope = 0.0;
  double share = retention.quantile(found.month, 0.5);
  for (int k = 0; k < kMaxSecants; ++k) {
    const auto gained = skin_volume(**trial, plan, share);
    if (!gained.ok()) return gained.status();
    slope = (*gained - gained_before) / (share - before);
    before = share;
    gained_before = *gained;
    const double next = std::clamp(share + (found.volume - *gained) / slope, kLeastShare, kMostShare);
    if (std::abs(next - share) <= kCloseness) break;
    share = next;
  }
  // The line goes on where a measurement lies beyond what was looked for.
  share = before + (found.volume - gained_before) / slope;
  return KeptShare{found.month, share, found.standard_error / slope};
}

absl::StatusOr<VectorXd> find_largest_multiples(const std::shared_ptr<const model::FaceModel>& model,
                                                const plan::SimulationSpec& plan, const std::vector<std::string>& zones,
                                                const VectorXd& bounds) {
  auto trial = TrialShape::create(model, plan);
  if (!trial.ok()) return trial.status();
  std::vector<double> tried;
  Eigen::MatrixXd pressures(static_cast<Index>(zones.size()), 0);
  for (const double multiple : kMultiples) {
    const absl::Status status = (*trial)->find(scaled(plan, multiple), true);
    const bool holds = status.ok() && (*trial)->share() == 1.0;
    VectorXd of_zone = VectorXd::Constant(bounds.size(), std::numeric_limits<double>::max());
    if (holds) {
      for (const simulation::ZoneReport& report : (*trial)->shape().zone_reports()) {
        const auto place = std::find(zones.begin(), zones.end(), report.name);
        if (place != zones.end()) of_zone[place - zones.begin()] = report.mean_pressure;
      }
    }
    tried.push_back(multiple);
    pressures.conservativeResize(Eigen::NoChange, static_cast<Index>(tried.size()));
    pressures.rightCols(1) = of_zone;
    if (!holds || (of_zone.array() > bounds.array()).all()) break;
  }
  return largest_multiples(VectorXd::Map(tried.data(), static_cast<Index>(tried.size())), pressures, bounds);
}

}  // namespace lipofill::forecast
