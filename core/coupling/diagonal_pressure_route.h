#pragma once

#include "core/coupling/pressure_route.h"
#include "core/coupling/sparse_pressure_factor.h"

namespace lipofill::coupling {

/// Walls that give way each by its own cell's pressure alone, C = diag(c): sparse LDL^T of
///
///     dt J + diag(c)
///
/// Checked by tests/unit/coupling/pressure_routes_test.cc.
class DiagonalPressureRoute : public PressureRoute {
 public:
  void set_walls(const WallCompliance& walls) override { compliance_ = walls.diagonal; }
  void multiply_walls(const Eigen::VectorXd& p, Eigen::VectorXd& product) override {
    product = compliance_.cwiseProduct(p);
  }
  bool solve(const PressureSystem& system, const Eigen::VectorXd& r, double tolerance, Eigen::VectorXd& dp,
             Eigen::VectorXd& moved) override;

 private:
  Eigen::VectorXd compliance_;  ///< c
  SparsePressureFactor factor_;
};

}  // namespace lipofill::coupling
