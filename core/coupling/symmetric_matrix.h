#pragma once

#include <Eigen/Core>

namespace lipofill::coupling {

/// A symmetric matrix stored as float32 and multiplied in float64: products of many cells are bound
/// by memory, so half the bytes, read once for both triangles, are four times the speed. Sums in a
/// fixed order. Checked by tests/unit/coupling/symmetric_matrix_test.cc.
class SymmetricMatrix {
 public:
  /// Takes the lower triangle of `matrix` (n, n), rounded.
  void assign(const Eigen::MatrixXd& matrix);
  Eigen::Index size() const { return lower_.cols(); }

  /// y = A x; x and y (n) are not the same.
  void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

 private:
  double scale_ = 1.0;     ///< a power of two: entries are scale_ lower_, so that float32's range is no bound on units
  Eigen::MatrixXf lower_;  ///< lower triangle; what is above it is not read
};

}  // namespace lipofill::coupling
