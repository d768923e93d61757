#pragma once

#include <Eigen/Core>

#include "core/coupling/conjugate_gradients.h"
#include "core/coupling/pressure_route.h"
#include "core/coupling/sparse_pressure_factor.h"

namespace lipofill::coupling {

/// Walls on tissue whose C is known by its product with a vector only, a solve with the tissue's
/// factor each, beside walls of their own, C = diag(c): conjugate gradients preconditioned by the
/// sparse LDL^T of
///
///     M = dt J + diag(C 1)
///
/// Checked by tests/unit/coupling/pressure_routes_test.cc.
class ImplicitPressureRoute : public PressureRoute {
 public:
  void set_walls(const WallCompliance& walls) override { walls_ = walls; }
  void multiply_walls(const Eigen::VectorXd& p, Eigen::VectorXd& product) override;
  bool solve(const PressureSystem& system, const Eigen::VectorXd& r, double tolerance, Eigen::VectorXd& dp,
             Eigen::VectorXd& moved) override;
  PressureCounts counts() const override { return {gradients_.n_solves(), gradients_.n_iterations(), 0}; }

 private:
  WallCompliance walls_;
  SparsePressureFactor factor_;
  ConjugateGradients gradients_;
  Eigen::VectorXd on_tissue_, moved_on_tissue_;  ///< p and C p of the cells on tissue
};

}  // namespace lipofill::coupling
