#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/planning/proposal_bounds.h"
#include "core/planning/proposal_points.h"
#include "core/planning/proposal_problem.h"
#include "core/planning/proposal_zones.h"
#include "core/planning/volume_slopes.h"
#include "core/simulation/trial_shape.h"

namespace lipofill::planning {

/// Volumes that were fitted, and the shape with them.
struct FittedVolumes {
  Eigen::VectorXd volumes;     ///< a zone [m3]
  Eigen::VectorXd pressure;    ///< the mean over each zone [Pa]
  std::vector<Bound> bound;    ///< that holds each of them
  Eigen::VectorXd noise_gain;  ///< standard deviation of each volume for a target that is off by 1 m [m2]
  Eigen::VectorXd distance;    ///< of the points that count, signed [m] (n of VolumeFit::points)
  Eigen::MatrixXd reach;       ///< of the distances by the volumes [1/m2] (n, zones)
  double mean_square = 0.0;    ///< of the distances, by area [m2]
  double max_lift = 0.0;       ///< [m]
  std::string state_hash;      ///< of a simulation with these volumes
  ProposalCost cost;

  double total() const { return volumes.sum(); }
  double max_pressure() const { return pressure.size() > 0 ? pressure.maxCoeff() : 0.0; }
};

/// Fits the volumes of a plan's zones to a target: Gauss-Newton on the distances d of points of the
/// skin, by their areas a,
///
///     minimise sum over k of a_k d_k(V)^2,   dd_k/dV_z = n_k . dx_k/dV_z,   n: gradient of the distance
///
/// within bounds of volumes, pressures and lift, each step a bounded linear problem
/// (proposal_step.h) with pressures and lifts that are linear in the volumes. dx/dV comes from the
/// held factor (TrialShape) at the first two shapes, and then from what the steps do (Broyden).
/// Shapes on the way follow one another; the last is from rest, and depends on its volumes alone.
/// What is found depends on what is passed to create() and find(), and not on earlier calls.
/// Checked by tests/unit/planning/proposal_test.cc.
class VolumeFit {
 public:
  /// @param one_each       with_one_injection_each()
  /// @param target         outlives the fit, as points and rest_distance do
  /// @param rest_distance  of the points, NaN where one has no target opposite [m]
  /// Errors as TrialShape::create.
  static absl::StatusOr<std::unique_ptr<VolumeFit>> create(std::shared_ptr<const model::FaceModel> model,
                                                           plan::SimulationSpec one_each, std::vector<SoughtZone> zones,
                                                           const SkinPoints& points, const TargetDistance& target,
                                                           const Eigen::VectorXd& rest_distance);

  /// FAILED_PRECONDITION, with figures, where no volumes are within the bounds or the tissue holds
  /// none; CANCELLED once it is unwanted.
  absl::StatusOr<FittedVolumes> find(const ProposalBounds& bounds, const Unwanted& unwanted);

  /// The shape at given volumes, from rest.
  absl::StatusOr<FittedVolumes> describe(const Eigen::VectorXd& volumes);
  /// Largest pressure over the zones of members whose layers' moduli are these times the model's,
  /// with the volumes found last [Pa] (members); infinite where the tissue does not hold them.
  absl::StatusOr<Eigen::VectorXd> find_member_pressures(const std::vector<Eigen::VectorXd>& moduli,
                                                        const Unwanted& unwanted);
  /// The shape found last.
  const simulation::TrialShape& shape() const { return *trial_; }
  const std::vector<SoughtZone>& zones() const { return zones_; }

 private:
  VolumeFit(std::unique_ptr<simulation::TrialShape> trial, std::vector<SoughtZone> zones, const SkinPoints& points,
            const TargetDistance& target, const Eigen::VectorXd& rest_distance);
  absl::StatusOr<FitState> evaluate(const Eigen::VectorXd& volumes, bool from_last);
  absl::StatusOr<FitState> begin(const ProposalBounds& bounds);
  absl::StatusOr<FitState> try_step(const FitState& state, const Eigen::VectorXd& wanted, const ProposalBounds& bounds);
  absl::Status differentiate();
  absl::StatusOr<Eigen::VectorXd> propose(const FitState& state, const ProposalBounds& bounds) const;
  FittedVolumes describe(const FitState& state, const ProposalBounds& bounds) const;
  std::vector<Bound> find_bounds(const FitState& state, const ProposalBounds& bounds) const;

  std::unique_ptr<simulation::TrialShape> trial_;
  std::vector<SoughtZone> zones_;
  const SkinPoints& points_;
  const TargetDistance& target_;
  const Eigen::VectorXd& rest_distance_;
  VolumeSlopes slopes_;
  bool is_at_path_end_ = false;
  ProposalCost cost_;
};

}  // namespace lipofill::planning
