#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/coupling/coupled_factor.h"

namespace lipofill::coupling {

/// The compliance of the walls of all films to pressure: gap' = rest + C p. It is one of
///
/// - diagonal (LUMPED; a Winkler wall, a/k a cell; a rigid wall, 0);
/// - dense: C of all cells;
/// - implicit: cells on tissue by solves with its factor, the others by the diagonal.
///
/// PressureSolver has a route for each.
struct WallCompliance {
  const Eigen::MatrixXd* dense = nullptr;  ///< (n, n) or null
  /// The diagonal (n). On the implicit route the entries of cells on tissue are their C 1, for the
  /// preconditioner alone.
  Eigen::VectorXd diagonal;
  CoupledFactor* tissue = nullptr;                 ///< the implicit route has one; null for others
  const std::vector<int>* tissue_cells = nullptr;  ///< cell of each row of the factor's B
};

}  // namespace lipofill::coupling
