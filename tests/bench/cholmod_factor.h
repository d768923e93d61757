#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "absl/status/status.h"

namespace lipofill::bench {

/// CHOLMOD as it comes: a factor of a symmetric matrix given by its lower triangle, analysed once.
class CholmodFactor {
 public:
  enum class Kind { kSupernodal, kSimplicial };

  /// @param order  elimination order; empty: CHOLMOD chooses
  CholmodFactor(const Eigen::SparseMatrix<double>& lower, Kind kind, std::vector<int> order = {});
  ~CholmodFactor();

  /// Factors new values in the same pattern. INTERNAL: kSupernodal and not positive definite, or no
  /// memory.
  absl::Status factorise(const Eigen::SparseMatrix<double>& lower);
  /// One solution a column, until the next call.
  Eigen::Map<const Eigen::MatrixXd> solve(const Eigen::MatrixXd& right_sides);

  std::vector<int> order() const;
  /// The last block of the factor (n, n), lower, rows and columns in the order of order().
  /// kSupernodal.
  Eigen::MatrixXd last_block(int n) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// CHOLMOD's own order of a matrix, with `n_more` unknowns after all of its own.
std::vector<int> order_with_more_last(const Eigen::SparseMatrix<double>& lower, int n_more);

}  // namespace lipofill::bench
