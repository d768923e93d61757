#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/coupling/coupled_factor.h"

namespace lipofill::coupling {

/// The compliance of the walls of all films to pressure: gap' = rest + C p. One of
///
/// - diagonal (LUMPED; a Winkler wall, a/k a cell; a rigid wall, 0);
/// - dense: C of all cells;
/// - implicit: cells on tissue by solves with its factor, the others by the diagonal.
struct WallCompliance {
  const Eigen::MatrixXd* dense = nullptr;  ///< (n, n) or null
  /// The diagonal (n). On the implicit route the entries of cells on tissue are their C 1, for the
  /// preconditioner alone.
  Eigen::VectorXd diagonal;
  CoupledFactor* tissue = nullptr;                 ///< of the implicit route, or null
  const std::vector<int>* tissue_cells = nullptr;  ///< cell of each row of the factor's B

  bool is_diagonal() const { return dense == nullptr && tissue == nullptr; }

  void multiply(const Eigen::VectorXd& p, Eigen::VectorXd& product) const {
    if (dense != nullptr) {
      product.noalias() = *dense * p;
      return;
    }
    product = diagonal.cwiseProduct(p);
    if (tissue == nullptr) return;
    const auto n = static_cast<Eigen::Index>(tissue_cells->size());
    Eigen::VectorXd part(n), moved;
    for (Eigen::Index k = 0; k < n; ++k) part[k] = p[(*tissue_cells)[k]];
    tissue->multiply_compliance(part, moved);
    for (Eigen::Index k = 0; k < n; ++k) product[(*tissue_cells)[k]] = moved[k];
  }
};

}  // namespace lipofill::coupling
