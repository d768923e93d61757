#include "core/coupling/symmetric_matrix.h"

#include <cmath>
#include <cstring>

namespace lipofill::coupling {
namespace {

constexpr int kColumns = 4;
constexpr int kLanes = 4;
using Doubles = double __attribute__((vector_size(kLanes * sizeof(double))));
using Floats = float __attribute__((vector_size(kLanes * sizeof(float))));

Doubles load(const double* from) {
  Doubles v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
Doubles load(const float* from) {
  Floats v;
  std::memcpy(&v, from, sizeof v);
  return __builtin_convertvector(v, Doubles);
}

/// y[r] += a[r] x_j and y_j += a[r] x[r] for the rows below the diagonal of kColumns columns `a`
/// from `first` on.
void add_columns(const float* const (&a)[kColumns], Eigen::Index first, Eigen::Index n, const double* x, double* y,
                 const double* x_of_column, double* y_of_column) {
  Doubles sum[kColumns] = {};
  Eigen::Index r = first;
  for (; r + kLanes <= n; r += kLanes) {
    const Doubles x_rows = load(x + r);
    Doubles y_rows = load(y + r);
    for (int c = 0; c < kColumns; ++c) {
      const Doubles values = load(a[c] + r);
      y_rows += values * x_of_column[c];
      sum[c] += values * x_rows;
    }
    std::memcpy(y + r, &y_rows, sizeof y_rows);
  }
  for (int c = 0; c < kColumns; ++c) {
    y_of_column[c] += (sum[c][0] + sum[c][1]) + (sum[c][2] + sum[c][3]);
    for (Eigen::Index rest = r; rest < n; ++rest) {
      y[rest] += static_cast<double>(a[c][rest]) * x_of_column[c];
      y_of_column[c] += static_cast<double>(a[c][rest]) * x[rest];
    }
  }
}

}  // namespace

void SymmetricMatrix::assign(const Eigen::MatrixXd& matrix) {
  const double largest = matrix.diagonal().cwiseAbs().maxCoeff();
  scale_ = largest > 0.0 ? std::exp2(std::ilogb(largest)) : 1.0;
  lower_ = (matrix / scale_).cast<float>();
}

void SymmetricMatrix::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  const Eigen::Index n = size();
  y.setZero(n);
  Eigen::Index j = 0;
  for (; j + kColumns <= n; j += kColumns) {
    const float* columns[kColumns];
    for (int c = 0; c < kColumns; ++c) columns[c] = lower_.data() + (j + c) * n;
    for (int c = 0; c < kColumns; ++c) {
      y[j + c] += static_cast<double>(columns[c][j + c]) * x[j + c];
      for (int r = c + 1; r < kColumns; ++r) {
        y[j + r] += static_cast<double>(columns[c][j + r]) * x[j + c];
        y[j + c] += static_cast<double>(columns[c][j + r]) * x[j + r];
      }
    }
    add_columns(columns, j + kColumns, n, x.data(), y.data(), x.data() + j, y.data() + j);
  }
  for (; j < n; ++j) {
    const float* column = lower_.data() + j * n;
    y[j] += static_cast<double>(column[j]) * x[j];
    for (Eigen::Index r = j + 1; r < n; ++r) {
      y[r] += static_cast<double>(column[r]) * x[j];
      y[j] += static_cast<double>(column[r]) * x[r];
    }
  }
  y *= scale_;
}

}  // namespace lipofill::coupling
