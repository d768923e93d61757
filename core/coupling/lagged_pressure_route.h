#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "core/coupling/conjugate_gradients.h"
#include "core/coupling/dense_pressure_route.h"
#include "core/coupling/symmetric_matrix.h"

namespace lipofill::coupling {

/// Many cells on walls that move one another: conjugate gradients preconditioned by the Cholesky
/// factor, in float32, of
///
///     M = J0 + C = L L^T
///
/// with the J0 of renew_preconditioner, which stays for as long as C does. z = M^-1 r also gives
///
///     C z = r - J0 z
///
/// so that an iteration passes over the factor only and not over C, and what it moves is exact to
/// float32. Where cells are held, z is not M^-1 r in all cells, and C d is a product with C. Where
/// conjugate gradients do not converge, the Cholesky factor of dt J + C (dense_pressure_route.h)
/// serves, and that is counted.
///
/// Checked by tests/unit/coupling/pressure_routes_test.cc and pressure_solver_test.cc.
class LaggedPressureRoute : public PressureRoute {
 public:
  /// Iterations, over all that a fresh preconditioner would need, that cost as much as a new one.
  static int iterations_of_a_preconditioner(int n_cells) { return 4 + n_cells / 45; }

  void set_walls(const WallCompliance& walls) override { direct_.set_walls(walls); }
  /// Computes C p with the C of the last renew_preconditioner.
  void multiply_walls(const Eigen::VectorXd& p, Eigen::VectorXd& product) override { compliance_.multiply(p, product); }
  /// `moved` is good to float32: multiply_walls is exact.
  bool solve(const PressureSystem& system, const Eigen::VectorXd& r, double tolerance, Eigen::VectorXd& dp,
             Eigen::VectorXd& moved) override;

  bool is_lagged() const override { return true; }
  void renew_preconditioner(const PressureSystem& system, const std::vector<Eigen::VectorXd>& mobility) override;

  PressureCounts counts() const override { return {gradients_.n_solves(), gradients_.n_iterations(), fallbacks_}; }

 private:
  void precondition(const Eigen::VectorXd& r, Eigen::VectorXd& z);
  void move(const ConjugateGradients::Iterate& at, Eigen::VectorXd& moved_direction);

  DensePressureRoute direct_;
  ConjugateGradients gradients_;
  SymmetricMatrix compliance_;                         ///< C
  std::vector<Eigen::SparseMatrix<double>> mobility_;  ///< J0 of each film
  double scale_ = 1.0;
  Eigen::MatrixXf factor_;  ///< L of scale_ M, as PanelSolve reads it
  bool is_exact_ = false;   ///< the factor is of M
  Eigen::VectorXf work_;
  Eigen::VectorXd moved_conditioned_;  ///< C z
  long fallbacks_ = 0;
};

}  // namespace lipofill::coupling
