#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/planning/proposal_bounds.h"
#include "core/planning/proposal_points.h"
#include "core/planning/proposal_step.h"
#include "core/planning/proposal_zones.h"
#include "core/planning/volume_slopes.h"

namespace lipofill::planning {

/// Volumes and the shape with them.
struct FitState {
  Eigen::VectorXd volumes;
  Eigen::VectorXd distance;    ///< of the points, 0 where there is no target opposite [m]
  Eigen::Matrix3Xd direction;  ///< gradient of the distance
  Eigen::Matrix3Xd skin;       ///< displacement of the nodes [m]
  Eigen::VectorXd pressure;    ///< of the zones [Pa]
  double mean_square = 0.0;
  double max_lift = 0.0;

  /// The largest share by which a bound is broken, 0 where all are kept to.
  double excess(const ProposalBounds& bounds) const;
};

/// The problem of a Gauss-Newton step: volumes [mL] with which distances are least by area, all
/// being linear in them, within the bounds of volumes, pressures, their total, and the lift where
/// it is largest. Checked by tests/unit/planning/proposal_test.cc.
/// @param slopes  at the state
BoundedProblem linearise(const FitState& state, const VolumeSlopes& slopes, const SkinPoints& points,
                         const std::vector<SoughtZone>& zones, const ProposalBounds& bounds);

}  // namespace lipofill::planning
