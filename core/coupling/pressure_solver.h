#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/coupling/lagged_pressure_route.h"
#include "core/coupling/pressure_route.h"
#include "core/coupling/pressure_system.h"
#include "core/coupling/wall_compliance.h"
#include "core/film/film_projection.h"

namespace lipofill::coupling {

/// Solves (dt J + C) dp = r in the cells of all films (pressure_system.h), by the route that is
/// made for their walls, chosen when they are first set. By what C is:
///
/// - diagonal: sparse LDL^T (diagonal_pressure_route.h);
/// - dense, up to kMaxDirectCells: Cholesky (dense_pressure_route.h);
/// - dense, more cells: conjugate gradients with a factor of an earlier state
///   (lagged_pressure_route.h);
/// - implicit: conjugate gradients with the factor of a diagonal C (implicit_pressure_route.h).
///
/// Checked by tests/unit/coupling/film_solve_test.cc and pressure_solver_test.cc.
class PressureSolver {
 public:
  static constexpr int kMaxDirectCells = 128;

  explicit PressureSolver(std::vector<film::FilmProjection*> films);

  /// Takes the walls of the solves to come, always of one kind; what it points to must outlive
  /// them.
  void set_walls(const WallCompliance& walls);
  /// Computes C p.
  void multiply_walls(const Eigen::VectorXd& p, Eigen::VectorXd& product) { route_->multiply_walls(p, product); }

  /// True when solves with these walls need renew_preconditioner first.
  bool is_lagged() const { return route_ != nullptr && route_->is_lagged(); }
  /// Iterations, over all that a fresh preconditioner would need, that cost as much as a new one.
  int iterations_of_a_preconditioner() const {
    return LaggedPressureRoute::iterations_of_a_preconditioner(system_.n_cells());
  }
  /// Makes the preconditioner of a dense C from J0, the values of dt J of each film in the order of
  /// FilmProjection::linearise.
  void renew_preconditioner(const std::vector<Eigen::VectorXd>& mobility) {
    route_->renew_preconditioner(system_, mobility);
  }

  /// Takes dt J of every film at the pressures `p`.
  /// @param held       cells whose dp is 0 (n)
  /// @param tolerance  of conjugate gradients: the largest residual that may be left [m3]
  /// @param moved      C dp [m3], of many cells to float32: multiply_walls is exact
  /// Returns false when the matrix cannot be factored.
  bool solve(const Eigen::VectorXd& p, const std::vector<char>& held, const Eigen::VectorXd& r, double tolerance,
             Eigen::VectorXd& dp, Eigen::VectorXd& moved);

  /// Counts since the start: solves by conjugate gradients, their iterations, and how often they
  /// did not converge.
  long iterative_solves() const { return counts().iterative_solves; }
  long iterations() const { return counts().iterations; }
  long fallbacks() const { return counts().fallbacks; }

 private:
  PressureCounts counts() const { return route_ != nullptr ? route_->counts() : PressureCounts(); }

  PressureSystem system_;
  std::unique_ptr<PressureRoute> route_;
  Eigen::VectorXd right_;
};

}  // namespace lipofill::coupling
