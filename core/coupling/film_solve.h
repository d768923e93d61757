#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/coupling/pressure_solver.h"
#include "core/film/film_projection.h"

namespace lipofill::coupling {

/// Cells of all films, one film after the other.
struct FilmSolution {
  Eigen::VectorXd pressure;           ///< [Pa]
  Eigen::VectorXd volume;             ///< V' [m3], from fluxes
  Eigen::VectorXd void_volume;        ///< gap that is neither fat nor closed, behind a front at the suction limit [m3]
  std::vector<Eigen::VectorXd> flux;  ///< a film [m3/s]
  int iterations = 0;
  bool converged = false;
  double change = 0.0;  ///< the last iteration changed the volume so much, relative to the fullest cell
};

/// Tolerance of a film step, relative to the volume of the fullest cell. A solution with a negative
/// volume is solved on to the tolerances of this type's own.
struct FilmTolerance {
  double change = 1e-10;    ///< bounds how the volume changes from one iteration on the thickness to the next
  double mismatch = 1e-11;  ///< bounds how gap and volume of a cell differ
};

/// Solves the film's step with the mobility at the new thickness: Picard iteration on the
/// thickness, and in each of its iterations the paper's eq. 9 (or 11) as the minimum of a convex
/// function of the pressure,
///
///     g0 + C p - V'(p) = void >= 0,   p >= lowest,   void (p - lowest) = 0
///
/// with g0 the gap at zero pressure and V' the film's volume by its fluxes (film_projection.h), by
/// Newton's method with a line search; cells at the suction limit are held (a primal-dual active
/// set). Linear films without a limit need one solve. Stable and positive at any step once
/// converged.
/// Checked by tests/unit/coupling/film_solve_test.cc and tests/verification/film/.
class FilmSolver {
 public:
  explicit FilmSolver(std::vector<film::FilmProjection*> films);

  PressureSolver& pressure_solver() { return solver_; }
  const PressureSolver& pressure_solver() const { return solver_; }

  /// @param lowest    the suction limit of each cell [Pa] (n), minus infinity: none; empty: none
  ///                  anywhere
  /// @param solution  pressure, volume and flux to start from; becomes the solution
  void solve(const Eigen::VectorXd& gap_without_pressure, const Eigen::VectorXd& lowest, FilmTolerance tolerance,
             FilmSolution& solution);

  /// Takes the mobility that solves of many cells are preconditioned with from the volumes and
  /// fluxes of a state, as the values of dt J of each film.
  void measure_mobility(const FilmSolution& at, std::vector<Eigen::VectorXd>& mobility);

 private:
  bool has_limit() const { return lowest_->size() > 0; }
  void begin_directions(const FilmSolution& solution);
  void turn_directions(const FilmSolution& solution);
  void set_thickness(const Eigen::VectorXd& volume);
  bool is_exact(double tolerance, FilmSolution& solution);
  bool solve_pressure(double tolerance, FilmSolution& solution);
  void evaluate(FilmSolution& solution);
  void hold_cells_at_the_limit(const Eigen::VectorXd& p);
  double mismatch(const Eigen::VectorXd& volume) const;
  void measure_void(FilmSolution& solution) const;
  void advance(FilmSolution& solution);
  void go(double share, FilmSolution& solution);

  std::vector<film::FilmProjection*> films_;
  PressureSolver solver_;
  const Eigen::VectorXd* gap_ = nullptr;
  const Eigen::VectorXd* lowest_ = nullptr;
  bool is_linear_ = true;
  std::vector<char> held_;
  std::vector<Eigen::VectorXd> direction_;  ///< flux whose sign tells where each edge is upwind
  std::vector<Eigen::VectorXi> turns_;      ///< count how often that sign turned in the step under way
  Eigen::VectorXd guess_;                   ///< volume whose thickness the mobility has
  Eigen::VectorXd moved_;                   ///< C p
  Eigen::VectorXd residual_;                ///< r = V' - g0 - C p
  Eigen::VectorXd step_, moved_step_;       ///< dp and C dp
  Eigen::VectorXd start_, moved_start_;
};

}  // namespace lipofill::coupling
