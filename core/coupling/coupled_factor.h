#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>

#include "absl/status/status.h"

namespace lipofill::coupling {

/// Factor of the tissue's S together with the films' B, which yields the compliance C = B S^-1 B^T on the way.
///
/// CHOLMOD factors the symmetric positive definite matrix
///
///     [ S  B^T ]          with the pressures ordered last and e larger than the largest eigenvalue of C,
///     [ B  e I ]          so that the last block of the factor is  L22 L22^T = e I - C.
///
/// C comes out of one supernodal factorisation, without a solve a cell (the paper's way), at the cost of digits: C is
/// exact to round-off relative to e, and e is kept within a small factor of the norm of C. Solves with S use the same
/// factor. The symbolic analysis is done once.
///
/// Decision record: core/doc/decisions/002-compliance-by-augmented-cholesky.md.
/// Checked by tests/unit/coupling/coupled_factor_test.cc against dense references.
class CoupledFactor {
 public:
  /// Analyses the patterns: the lower triangle of S (n_dofs, n_dofs), columns and rows ascending, and B (n_cells,
  /// n_dofs).
  CoupledFactor(const Eigen::SparseMatrix<double>& s, const Eigen::SparseMatrix<double>& b);
  ~CoupledFactor();

  /// Memory that the factor takes [bytes], known before the first factorise; infinite when the analysis itself failed.
  double factor_bytes() const;
  CoupledFactor(const CoupledFactor&) = delete;
  CoupledFactor& operator=(const CoupledFactor&) = delete;

  /// Factors new values in the same patterns. INTERNAL when S is not positive definite; the factor is then not usable.
  absl::Status factorise(const Eigen::SparseMatrix<double>& s, const Eigen::SparseMatrix<double>& b);

  /// C of the last factorise [m3/Pa] (n_cells, n_cells), symmetric.
  const Eigen::MatrixXd& compliance() const;

  /// B S^-1 r and, for a pressure p, dx = S^-1 (r + B^T p). The two calls share the factor; each is one solve.
  Eigen::VectorXd compute_gap_response(const Eigen::VectorXd& r);
  Eigen::VectorXd solve_displacement(const Eigen::VectorXd& r, const Eigen::VectorXd& gap_response,
                                     const Eigen::VectorXd& pressure);

  /// The shift e, part of the state: it decides the rounding of C. 0 before the first factorise.
  double shift() const;
  void set_shift(double shift);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lipofill::coupling
