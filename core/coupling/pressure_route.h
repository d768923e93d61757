#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/coupling/pressure_system.h"
#include "core/coupling/wall_compliance.h"

namespace lipofill::coupling {

/// Counts since the start.
struct PressureCounts {
  long iterative_solves = 0;  ///< conjugate gradients made them
  long iterations = 0;        ///< those took so many
  long fallbacks = 0;         ///< times that they did not converge
};

/// A way to solve
///
///     (dt J + C) dp = r,   dp = 0 in the cells that are held
///
/// for one kind of walls: diagonal_pressure_route.h, dense_pressure_route.h,
/// lagged_pressure_route.h and implicit_pressure_route.h. PressureSolver chooses.
class PressureRoute {
 public:
  virtual ~PressureRoute() = default;

  /// Takes the walls of the solves to come, always of one kind; what it points to must outlive
  /// them.
  virtual void set_walls(const WallCompliance& walls) = 0;
  /// Computes C p.
  virtual void multiply_walls(const Eigen::VectorXd& p, Eigen::VectorXd& product) = 0;

  /// @param r          0 in the cells that are held
  /// @param tolerance  of conjugate gradients: the largest residual that may be left [m3]
  /// @param moved      C dp [m3]
  /// Returns false when the matrix cannot be factored, or nothing converges.
  virtual bool solve(const PressureSystem& system, const Eigen::VectorXd& r, double tolerance, Eigen::VectorXd& dp,
                     Eigen::VectorXd& moved) = 0;

  /// True when solves with new walls need renew_preconditioner first.
  virtual bool is_lagged() const { return false; }
  /// Takes J0 for the preconditioner, the values of dt J of each film.
  virtual void renew_preconditioner(const PressureSystem& /*system*/,
                                    const std::vector<Eigen::VectorXd>& /*mobility*/) {}

  virtual PressureCounts counts() const { return {}; }
};

}  // namespace lipofill::coupling
