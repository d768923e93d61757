#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>

#include "tests/bench/cholmod_factor.h"
#include "tests/bench/linear_step.h"

namespace lipofill::bench {

/// Conjugate gradients for (J + C) p = r, C = B S^-1 B^T by a solve with S, preconditioned by J + R
/// with R = diag(C 1).
class PressureCg {
 public:
  explicit PressureCg(const LinearStep& step, double tolerance = 1e-10) : tolerance_(tolerance) {
    preconditioner_.analyzePattern(step.j);
  }

  /// @param factor  of S
  Eigen::VectorXd solve(const LinearStep& step, CholmodFactor& factor, const Eigen::VectorXd& r);
  int iterations() const { return iterations_; }

 private:
  void prepare(const LinearStep& step, CholmodFactor& factor);

  double tolerance_;
  int iterations_ = 0;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> preconditioner_;
};

}  // namespace lipofill::bench
