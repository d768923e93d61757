#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/coupling/pressure_solver.h"
#include "core/film/film_projection.h"

namespace lipofill::coupling {

/// Cells of all films, one film after the other.
struct FilmSolveResult {
  Eigen::VectorXd pressure;           ///< [Pa]
  Eigen::VectorXd volume;             ///< V' [m3], from fluxes
  Eigen::VectorXd void_volume;        ///< gap that is neither fat nor closed, behind a front at the suction limit [m3]
  std::vector<Eigen::VectorXd> flux;  ///< a film [m3/s]
  int iterations = 0;
  bool converged = false;
  double change = 0.0;  ///< of the volume in the last iteration, relative to the fullest cell
};

/// Solves the film's step with the mobility at the new thickness: Picard iteration on the thickness, and in each of its
/// iterations the paper's eq. 9 (or 11) as the minimum of a convex function of the pressure,
///
///     g0 + C p - V'(p) = void >= 0,   p >= lowest,   void (p - lowest) = 0
///
/// with g0 the gap at zero pressure and V' the film's volume by its fluxes (film_projection.h), by Newton's method with
/// a line search; cells at the suction limit are held (a primal-dual active set). Linear films without a limit need one
/// solve. Stable and positive at any step once converged.
/// @param lowest  the suction limit of each cell [Pa] (n), minus infinity: none; empty: none anywhere
/// @param start   pressure, volume and flux to start from (those at the start of the step)
/// Checked by tests/unit/coupling/film_solve_test.cc and tests/verification/film/.
FilmSolveResult solve_films(std::vector<film::FilmProjection*> films, const WallCompliance& walls,
                            const Eigen::VectorXd& gap_without_pressure, const Eigen::VectorXd& lowest,
                            const FilmSolveResult& start);

}  // namespace lipofill::coupling
