#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

#include "core/coupling/pressure_system.h"

namespace lipofill::coupling {

/// Sparse factor of the films' mobility and a compliance of each cell's own,
///
///     dt J + diag(c) = L D L^T
///
/// in a pattern that never changes.
class SparsePressureFactor {
 public:
  /// Factors the matrix. False when it cannot be factored.
  bool factor(const PressureSystem& system, const Eigen::VectorXd& compliance);
  /// Solves (dt J + diag(c)) z = r.
  void solve(const Eigen::VectorXd& r, Eigen::VectorXd& z) const { z = factor_.solve(r); }

 private:
  std::vector<Eigen::Triplet<double>> triplets_;
  Eigen::VectorXd diagonal_;
  Eigen::SparseMatrix<double> matrix_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
  bool is_analysed_ = false;
};

}  // namespace lipofill::coupling
