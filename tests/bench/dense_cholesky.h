#pragma once

#include <Eigen/Core>

#include "core/coupling/blas.h"

namespace lipofill::bench {

/// Cholesky factor of a dense symmetric positive definite matrix, by LAPACK.
class DenseCholesky {
 public:
  /// Takes the lower triangle.
  explicit DenseCholesky(Eigen::MatrixXd matrix) : factor_(std::move(matrix)) {
    is_definite_ = coupling::blas::factor_lower(size(), factor_.data(), size());
  }

  bool is_definite() const { return is_definite_; }
  Eigen::VectorXd solve(Eigen::VectorXd x) const {
    coupling::blas::solve_lower(size(), factor_.data(), size(), x.data(), false);
    coupling::blas::solve_lower(size(), factor_.data(), size(), x.data(), true);
    return x;
  }

 private:
  int size() const { return static_cast<int>(factor_.cols()); }

  Eigen::MatrixXd factor_;
  bool is_definite_ = false;
};

}  // namespace lipofill::bench
