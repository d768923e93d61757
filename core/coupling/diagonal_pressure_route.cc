#include "core/coupling/diagonal_pressure_route.h"

namespace lipofill::coupling {

bool DiagonalPressureRoute::solve(const PressureSystem& system, const Eigen::VectorXd& r, double /*tolerance*/,
                                  Eigen::VectorXd& dp, Eigen::VectorXd& moved) {
  if (!factor_.factor(system, compliance_)) return false;
  factor_.solve(r, dp);
  multiply_walls(dp, moved);
  return dp.allFinite();
}

}  // namespace lipofill::coupling
