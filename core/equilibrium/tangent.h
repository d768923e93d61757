#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/equilibrium/held_response.h"

namespace lipofill::equilibrium {

/// A small change of what a shape in balance is asked to hold, a unit of a parameter.
struct LoadChange {
  Eigen::VectorXd force;   ///< more of r, a value a degree of freedom [N]
  Eigen::VectorXd volume;  ///< more in each row [m3]; without meaning for a pool at the suction limit
};

/// The tangent says what the shape does then.
struct Tangent {
  Eigen::VectorXd displacement;  ///< a value a degree of freedom [m]
  Eigen::VectorXd pressure;      ///< of each row [Pa]
};

/// Finds how a shape in balance answers to small changes, to first order, its active sets as they
/// are:
///
///     J (dx, dp) = (force, volume),   J = -d(r, gap)/d(x, p) at the shape
///
/// J has terms that the held factor leaves out: an answer is corrected by that factor until what is
/// left of it, by the rate at which corrections fall, is less than 0.2 %, with J (dx, dp) from a
/// difference of forces and gaps along (dx, dp). All changes are answered side by side; an answer
/// does not depend on the others. Nothing for one that does not converge, nor where there is no
/// factor. The balance is at the shape before and after.
/// Checked by tests/unit/equilibrium/tangent_test.cc.
std::vector<std::optional<Tangent>> find_tangents(StaticBalance& balance, HeldResponse& response, const Pools& pools,
                                                  const Shape& shape, const Eigen::VectorXd& springs,
                                                  const std::vector<LoadChange>& changes);

}  // namespace lipofill::equilibrium
