#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "absl/status/status.h"

namespace lipofill::bench {

/// MUMPS as it comes: multifrontal L D L^T of a symmetric matrix given by its lower triangle, in
/// double or single precision, without pivoting; optionally with the last unknowns kept apart as
/// its Schur complement. Real is double or float.
template <typename Real>
class MumpsFactor {
 public:
  /// @param order    elimination order; empty: MUMPS chooses
  /// @param n_schur  how many of the last unknowns stay in the Schur complement
  MumpsFactor(const Eigen::SparseMatrix<double>& lower, const std::vector<int>& order, int n_schur = 0);
  ~MumpsFactor();

  /// Factors new values in the same pattern. INTERNAL with MUMPS' own code.
  absl::Status factorise(const Eigen::SparseMatrix<double>& lower);
  /// Without a Schur complement.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side);

  /// Both triangles (n_schur, n_schur).
  Eigen::MatrixXd schur_complement() const;
  /// Right side of the Schur complement's system, for a right side of all unknowns.
  Eigen::VectorXd condense(const Eigen::VectorXd& right_side);
  /// All unknowns, from the solution of the Schur complement's system; after condense().
  Eigen::VectorXd expand(const Eigen::VectorXd& schur_solution);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lipofill::bench
