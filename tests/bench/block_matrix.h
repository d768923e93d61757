#pragma once

#include <Eigen/SparseCore>

#include "tests/bench/linear_step.h"

namespace lipofill::bench {

/// The lower triangle of
///
///     [ S  B^T ]
///     [ B   T  ]
///
/// with T = -J, which makes it quasi-definite, or any other lower triangle of the films' size.
class BlockMatrix {
 public:
  BlockMatrix(const LinearStep& step, const Eigen::SparseMatrix<double>& corner);

  /// Takes new values in the same patterns.
  void fill(const LinearStep& step, const Eigen::SparseMatrix<double>& corner);
  const Eigen::SparseMatrix<double>& lower() const { return lower_; }

 private:
  Eigen::SparseMatrix<double> lower_;
};

/// The lower triangle of factor * J.
Eigen::SparseMatrix<double> lower_of_films(const LinearStep& step, double factor);
Eigen::SparseMatrix<double> scaled_identity(int n, double factor);

}  // namespace lipofill::bench
