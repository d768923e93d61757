#include "core/coupling/dense_pressure_route.h"

#include "core/coupling/algebra_threads.h"
#include "core/coupling/blas.h"

namespace lipofill::coupling {

bool DensePressureRoute::solve(const PressureSystem& system, const Eigen::VectorXd& r, double /*tolerance*/,
                               Eigen::VectorXd& dp, Eigen::VectorXd& moved) {
  if (!solve_pressure(system, r, dp)) return false;
  multiply_walls(dp, moved);
  return dp.allFinite();
}

bool DensePressureRoute::solve_pressure(const PressureSystem& system, const Eigen::VectorXd& r, Eigen::VectorXd& dp) {
  pin_algebra_to_this_thread();
  const int n = system.n_cells();
  matrix_ = *compliance_;
  system.for_each_entry([&](int row, int column, double value) { matrix_(row, column) += value; });
  for (const int i : system.gauge_cells()) matrix_(i, i) *= 2.0;
  for (int i = 0; i < n; ++i) {
    if (!system.is_held(i)) continue;
    const double diagonal = matrix_(i, i);
    matrix_.row(i).setZero();
    matrix_.col(i).setZero();
    matrix_(i, i) = diagonal;
  }
  if (!blas::factor_lower(n, matrix_.data(), n)) return false;
  dp = r;
  blas::solve_lower(n, matrix_.data(), n, dp.data(), false);
  blas::solve_lower(n, matrix_.data(), n, dp.data(), true);
  return true;
}

}  // namespace lipofill::coupling
