#include "core/coupling/sparse_pressure_factor.h"

namespace lipofill::coupling {

bool SparsePressureFactor::factor(const PressureSystem& system, const Eigen::VectorXd& compliance) {
  const int n = system.n_cells();
  triplets_.clear();
  triplets_.reserve(10 * static_cast<size_t>(n));
  diagonal_.setZero(n);
  system.for_each_entry([&](int row, int column, double value) {
    const bool coupled = row == column || !(system.is_held(row) || system.is_held(column));
    triplets_.emplace_back(row, column, coupled ? value : 0.0);
    if (row == column) diagonal_[row] = value;
  });
  for (int i = 0; i < n; ++i) triplets_.emplace_back(i, i, compliance[i]);
  for (const int i : system.gauge_cells()) triplets_.emplace_back(i, i, diagonal_[i]);
  matrix_.resize(n, n);
  matrix_.setFromTriplets(triplets_.begin(), triplets_.end());
  if (!is_analysed_) factor_.analyzePattern(matrix_);
  is_analysed_ = true;
  factor_.factorize(matrix_);
  return factor_.info() == Eigen::Success;
}

}  // namespace lipofill::coupling
