#pragma once

#include "core/coupling/pressure_route.h"

namespace lipofill::coupling {

/// Few cells on walls that move one another: Cholesky of the dense
///
///     dt J + C = L L^T,   dp = L^-T L^-1 r
///
/// Checked by tests/unit/coupling/pressure_routes_test.cc.
class DensePressureRoute : public PressureRoute {
 public:
  void set_walls(const WallCompliance& walls) override { compliance_ = walls.dense; }
  void multiply_walls(const Eigen::VectorXd& p, Eigen::VectorXd& product) override {
    product.noalias() = *compliance_ * p;
  }
  bool solve(const PressureSystem& system, const Eigen::VectorXd& r, double tolerance, Eigen::VectorXd& dp,
             Eigen::VectorXd& moved) override;

  /// The compliance C [m3/Pa].
  const Eigen::MatrixXd& compliance() const { return *compliance_; }
  /// Solves for the pressures alone. False when the matrix cannot be factored.
  bool solve_pressure(const PressureSystem& system, const Eigen::VectorXd& r, Eigen::VectorXd& dp);

 private:
  const Eigen::MatrixXd* compliance_ = nullptr;
  Eigen::MatrixXd matrix_;  ///< dt J + C, then L
};

}  // namespace lipofill::coupling
