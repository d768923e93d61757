#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/film/film_projection.h"

namespace lipofill::coupling {

/// How the walls of all films give way to pressure, in volume/pressure space: gap' = rest + C p. Either full (the
/// tissue, EXACT) or diagonal (LUMPED; a Winkler wall, a/k a cell; a rigid wall, 0).
struct WallCompliance {
  const Eigen::MatrixXd* full = nullptr;  ///< C (n, n) or null
  Eigen::VectorXd diagonal;               ///< (n), used when `full` is null
};

/// Cells of all films, one film after the other.
struct FilmSolveResult {
  Eigen::VectorXd pressure;           ///< [Pa]
  Eigen::VectorXd volume;             ///< V' [m3], from fluxes
  std::vector<Eigen::VectorXd> flux;  ///< a film [m3/s]
  int iterations = 0;
  bool converged = false;
  double change = 0.0;  ///< of the volume in the last iteration, relative to the fullest cell
};

/// Solves the film's step with the mobility at the new thickness, by Picard iteration on the paper's eq. 9 (or 11):
///
///     (dt J(h') + C) p = V*(h') - g0,     V' = V* - dt J p
///
/// with g0 the gap at zero pressure. Stable and positive at any step once converged.
///
/// Components of a film whose walls are rigid have a pressure that is known up to a constant only: it is fixed at zero
/// in the component's first cell, and what is injected there must balance.
/// @param start  volume and flux to start from (volumes at the start of the step and the fluxes of the last step)
/// Checked by tests/unit/coupling/film_solve_test.cc and tests/verification/film/.
FilmSolveResult solve_films(std::vector<film::FilmProjection*> films, const WallCompliance& walls,
                            const Eigen::VectorXd& gap_without_pressure, const FilmSolveResult& start);

}  // namespace lipofill::coupling
