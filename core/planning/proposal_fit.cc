#include "core/planning/proposal_fit.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/units.h"
#include "core/planning/proposal_problem.h"

namespace lipofill::planning {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Gauss-Newton steps at most; four do for most.
constexpr int kMaxSteps = 10;
/// The derivatives of so many shapes are solved for; then they follow from the steps.
constexpr int kDerivatives = 2;
/// A step that changes no volume by more than this share of the largest, or this much, is the last.
constexpr double kLeastStep = 2e-3;
constexpr double kLeastVolume = 2e-9;
/// A step that makes things worse is halved so often at most.
constexpr int kMaxHalvings = 5;
/// Worse by less is as good: shapes that follow others are off by some 0.001 mm.
constexpr double kAsGood = 1e-3;
/// A bound is kept to where it is broken by no more than this share.
constexpr double kTolerance = 1e-3;
/// Volumes this near to a bound are held by it [m3], pressures and lifts within this share.
constexpr double kAtBound = 3e-9;
constexpr double kAtShare = 5e-3;
/// Where the tissue does not take all of the volume, the fit goes on from this share of what it
/// takes.
constexpr double kBackFromPathEnd = 0.9;

constexpr double kPerMl = kCubicMetresPerMillilitre;

}  // namespace

absl::StatusOr<std::unique_ptr<VolumeFit>> VolumeFit::create(std::shared_ptr<const model::FaceModel> model,
                                                             plan::SimulationSpec one_each,
                                                             std::vector<SoughtZone> zones, const SkinPoints& points,
                                                             const TargetDistance& target,
                                                             const VectorXd& rest_distance) {
  auto trial = simulation::TrialShape::create(std::move(model), std::move(one_each));
  if (!trial.ok()) return trial.status();
  return std::unique_ptr<VolumeFit>(new VolumeFit(*std::move(trial), std::move(zones), points, target, rest_distance));
}

VolumeFit::VolumeFit(std::unique_ptr<simulation::TrialShape> trial, std::vector<SoughtZone> zones,
                     const SkinPoints& points, const TargetDistance& target, const VectorXd& rest_distance)
    : trial_(std::move(trial)),
      zones_(std::move(zones)),
      points_(points),
      target_(target),
      rest_distance_(rest_distance) {}

/// The shape with these volumes; where not all goes in, that with what does.
absl::StatusOr<FitState> VolumeFit::evaluate(const VectorXd& volumes, bool from_last) {
  simulation::TrialVolumes trial;
  for (size_t z = 0; z < zones_.size(); ++z) trial.injections.push_back({z, volumes[static_cast<Index>(z)]});
  if (const absl::Status found = trial_->find(trial, from_last); !found.ok()) return found;
  ++cost_.shapes;
  cost_.factorisations += trial_->shape().report().cost.factorisations;
  FitState state;
  state.volumes = trial_->share() * volumes;
  state.skin = trial_->skin_displacement();
  state.max_lift = state.skin.colwise().norm().maxCoeff();
  state.pressure.resize(volumes.size());
  std::map<std::string, double> pressures;
  for (const auto& zone : trial_->shape().zone_reports()) pressures[zone.name] = zone.mean_pressure;
  for (size_t z = 0; z < zones_.size(); ++z) state.pressure[static_cast<Index>(z)] = pressures[zones_[z].name];
  const Eigen::Matrix3Xd moved = points_.rest.points + points_.gather(state.skin);
  state.distance.setZero(points_.n());
  state.direction.setZero(3, points_.n());
  double area = 0.0;
  for (Index k = 0; k < points_.n(); ++k) {
    if (std::isnan(rest_distance_[k])) continue;
    const TargetSide side = target_.at(moved.col(k));
    if (side.is_off) continue;
    state.distance[k] = side.distance;
    state.direction.col(k) = side.direction;
    area += points_.area[k];
  }
  if (area > 0.0) state.mean_square = points_.area.dot(state.distance.cwiseAbs2()) / area;
  return state;
}

/// The first shape: zones filled with what the skin over them lacks.
absl::StatusOr<FitState> VolumeFit::begin(const ProposalBounds& bounds) {
  VectorXd volumes(static_cast<Index>(zones_.size())), low(volumes.size());
  for (Index z = 0; z < volumes.size(); ++z) {
    const VolumeRange& range = zones_[static_cast<size_t>(z)].bounds;
    low[z] = range.low;
    volumes[z] = std::clamp(zones_[static_cast<size_t>(z)].missing, range.low, range.high);
  }
  if (volumes.sum() > bounds.max_total) {
    const double share = (bounds.max_total - low.sum()) / (volumes.sum() - low.sum());
    volumes = low + share * (volumes - low);
  }
  is_at_path_end_ = false;
  auto state = evaluate(volumes, false);
  for (int k = 0; k < kMaxHalvings && state.ok() && trial_->share() < 1.0; ++k) {
    is_at_path_end_ = true;
    volumes *= kBackFromPathEnd * trial_->share();
    state = evaluate(volumes, false);
  }
  if (state.ok() && trial_->share() < 1.0) {
    return absl::FailedPreconditionError("the tissue holds no more than it does at rest: " + trial_->reason());
  }
  return state;
}

absl::Status VolumeFit::differentiate() {
  const absl::Status found = slopes_.differentiate(*trial_, zones_);
  if (found.ok()) cost_.derivatives += static_cast<int>(zones_.size());
  return found;
}

/// The volumes that are best where everything is linear in them.
absl::StatusOr<VectorXd> VolumeFit::propose(const FitState& state, const ProposalBounds& bounds) const {
  const auto found = solve_bounded(linearise(state, slopes_, points_, zones_, bounds));
  if (!found.ok()) return found.status();
  return VectorXd(kPerMl * *found);
}

/// The shape with the wanted volumes, or with a part of the step to them where that makes things
/// worse or the tissue does not take it; the state itself where no part helps.
absl::StatusOr<FitState> VolumeFit::try_step(const FitState& state, const VectorXd& wanted,
                                             const ProposalBounds& bounds) {
  VectorXd step = wanted - state.volumes;
  for (int k = 0; k <= kMaxHalvings; ++k, step *= 0.5) {
    auto next = evaluate(state.volumes + step, true);
    if (!next.ok()) return next.status();
    if (trial_->share() < 1.0) {
      is_at_path_end_ = true;
      continue;
    }
    const double excess = state.excess(bounds), next_excess = next->excess(bounds);
    const bool is_closer = next->mean_square <= (1.0 + kAsGood) * state.mean_square;
    if (excess > kTolerance ? next_excess < excess : is_closer) return next;
  }
  return state;
}

absl::StatusOr<FittedVolumes> VolumeFit::find(const ProposalBounds& bounds, const Unwanted& unwanted) {
  cost_ = {};
  auto begun = begin(bounds);
  if (!begun.ok()) return begun.status();
  FitState state = *std::move(begun);
  VectorXd wanted = state.volumes;
  for (int step = 0; step < kMaxSteps; ++step) {
    if (const absl::Status status = check_wanted(unwanted); !status.ok()) return status;
    if (step < kDerivatives) {
      if (const absl::Status status = differentiate(); !status.ok()) return status;
    }
    const auto proposed = propose(state, bounds);
    if (!proposed.ok()) return proposed.status();
    wanted = *proposed;
    const double change = (wanted - state.volumes).cwiseAbs().maxCoeff();
    const double least = std::max(kLeastVolume, kLeastStep * wanted.cwiseAbs().maxCoeff());
    if (step >= kDerivatives - 1 && change <= least) break;
    auto next = try_step(state, wanted, bounds);
    if (!next.ok()) return next.status();
    if (next->volumes == state.volumes) {
      wanted = state.volumes;
      break;
    }
    slopes_.learn(next->volumes - state.volumes, next->skin - state.skin, next->pressure - state.pressure);
    state = *std::move(next);
  }
  auto settled = evaluate(round_volumes(wanted), false);
  if (!settled.ok()) return settled.status();
  if (trial_->share() < 1.0)
    return absl::FailedPreconditionError("the tissue does not hold what was fitted: " + trial_->reason());
  if (settled->excess(bounds) > kTolerance) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "no volumes are within the bounds: with %.2f mL the pressure is %.2f kPa and the skin moves by %.2f mm",
        settled->volumes.sum() / kPerMl, settled->pressure.maxCoeff() / kPascalsPerKilopascal,
        settled->max_lift * kMillimetresPerMetre));
  }
  return describe(*settled, bounds);
}

absl::StatusOr<FittedVolumes> VolumeFit::describe(const VectorXd& volumes) {
  cost_ = {};
  const auto state = evaluate(volumes, false);
  if (!state.ok()) return state.status();
  if (const absl::Status status = differentiate(); !status.ok()) return status;
  return describe(*state, {});
}

absl::StatusOr<VectorXd> VolumeFit::find_member_pressures(const std::vector<VectorXd>& moduli,
                                                          const Unwanted& unwanted) {
  const auto pressures = trial_->find_member_pressures(moduli, unwanted);
  if (!pressures.ok()) return pressures.status();
  return VectorXd(pressures->colwise().maxCoeff().transpose());
}

std::vector<Bound> VolumeFit::find_bounds(const FitState& state, const ProposalBounds& bounds) const {
  std::vector<Bound> found(zones_.size(), Bound::kNone);
  const bool total = state.volumes.sum() > bounds.max_total - kAtBound * static_cast<double>(zones_.size());
  const bool lift = state.max_lift > (1.0 - kAtShare) * bounds.max_lift;
  Index top = 0;
  state.skin.colwise().norm().maxCoeff(&top);
  for (size_t z = 0; z < zones_.size(); ++z) {
    const VolumeRange& range = zones_[z].bounds;
    const double volume = state.volumes[static_cast<Index>(z)];
    const bool lifts_top = slopes_.skin()[z].col(top).norm() > 0.3 * slopes_.skin()[z].colwise().norm().maxCoeff();
    if (volume > range.high - kAtBound) {
      found[z] = Bound::kMaxZone;
    } else if (volume < range.low + kAtBound) {
      found[z] = Bound::kMinZone;
    } else if (state.pressure[static_cast<Index>(z)] > (1.0 - kAtShare) * bounds.max_pressure) {
      found[z] = Bound::kMaxPressure;
    } else if (lift && lifts_top) {
      found[z] = Bound::kMaxLift;
    } else if (total) {
      found[z] = Bound::kMaxTotal;
    } else if (is_at_path_end_) {
      found[z] = Bound::kPath;
    }
  }
  return found;
}

FittedVolumes VolumeFit::describe(const FitState& state, const ProposalBounds& bounds) const {
  FittedVolumes fitted;
  fitted.volumes = state.volumes;
  fitted.pressure = state.pressure;
  fitted.bound = find_bounds(state, bounds);
  fitted.distance = state.distance;
  fitted.reach = slopes_.of_distance(points_, state.direction);
  fitted.mean_square = state.mean_square;
  fitted.max_lift = state.max_lift;
  fitted.state_hash = trial_->shape().state_hash();
  fitted.cost = cost_;
  // Errors of the target, of each point on its own, reach the volumes by (A^T W A)^-1 A^T W, W:
  // areas.
  const Eigen::MatrixXd weighted = points_.area.asDiagonal() * (kPerMl * fitted.reach);
  const Eigen::MatrixXd normal = kPerMl * fitted.reach.transpose() * weighted;
  const Eigen::MatrixXd inverse = normal.completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::MatrixXd covariance = inverse * (weighted.transpose() * weighted) * inverse;
  fitted.noise_gain = kPerMl * covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return fitted;
}

}  // namespace lipofill::planning
