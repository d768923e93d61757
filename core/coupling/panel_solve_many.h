#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/base/lanes.h"

namespace lipofill::coupling {

/// Eight numbers, one of each right side, in as many registers as they fill.
template <typename Scalar>
struct RowOfEight;

template <>
struct RowOfEight<float> {
  using Part = float __attribute__((vector_size(32)));
  Part all;

  LIPOFILL_INLINE void scale(float factor) { all *= factor; }
  /// Takes share times another row off, rounded once where the processor can.
  LIPOFILL_INLINE void subtract(float share, const RowOfEight& row) {
#if defined(__AVX2__) && defined(__FMA__)
    all = _mm256_fnmadd_ps(_mm256_set1_ps(share), row.all, all);
#else
    all -= share * row.all;
#endif
  }
};

template <>
struct RowOfEight<double> {
  Lanes low, high;

  LIPOFILL_INLINE void scale(double factor) {
    low *= factor;
    high *= factor;
  }
  LIPOFILL_INLINE void subtract(double share, const RowOfEight& row) {
    low = multiply_add(fill_lanes(-share), row.low, low);
    high = multiply_add(fill_lanes(-share), row.high, high);
  }
};

/// PanelSolve (panel_solve.h) for kWidth right sides at once, which share the reading of the
/// factor. t is row by row: kWidth values of the first row, then those of the next. Each right side
/// goes through its sums in an order of its own, so that its solution does not depend on those
/// beside it. Checked by tests/unit/coupling/panel_solve_many_test.cc.
template <typename Scalar>
class PanelSolveMany {
 public:
  static constexpr int kWidth = 8;

  PanelSolveMany(const Scalar* panel, int n_rows, int n_columns)
      : panel_(panel), n_rows_(n_rows), n_columns_(n_columns) {}

  /// [t1; t2] <- [L1^-1 t1; t2 - L2 L1^-1 t1], for each right side.
  void forward(Scalar* t) const {
    int j = 0;
    for (; j + kSideBySide <= n_columns_; j += kSideBySide) forward_columns<kSideBySide>(j, t);
    for (; j < n_columns_; ++j) forward_columns<1>(j, t);
  }

  /// t1 <- L1^-T (t1 - L2^T t2), for each right side.
  void backward(Scalar* t) const {
    int j = n_columns_;
    for (; j % kSideBySide != 0; --j) backward_columns<1>(j - 1, t);
    for (; j > 0; j -= kSideBySide) backward_columns<kSideBySide>(j - kSideBySide, t);
  }

 private:
  using Row = RowOfEight<Scalar>;
  /// Columns whose rows stay in registers.
  static constexpr int kSideBySide = sizeof(Row) > 32 ? 4 : 8;

  /// Values of a cache line, and those on their way at least.
  static constexpr int kLine = 64 / static_cast<int>(sizeof(Scalar));
  static constexpr std::int64_t kAhead = 8192 / sizeof(Scalar);

  std::int64_t ahead(int n) const { return std::max<std::int64_t>(n * n_rows_, kAhead); }
  template <int n>
  LIPOFILL_INLINE void fetch(int j, int r, std::int64_t ahead) const {
    for (int c = 0; c < n; ++c) __builtin_prefetch(panel_ + static_cast<std::int64_t>(j + c) * n_rows_ + r + ahead);
  }
  Scalar at(int r, int c) const { return panel_[static_cast<std::int64_t>(c) * n_rows_ + r]; }
  static LIPOFILL_INLINE Row load(const Scalar* t, int r) {
    Row row;
    std::memcpy(&row, t + static_cast<std::int64_t>(r) * kWidth, sizeof row);
    return row;
  }
  static LIPOFILL_INLINE void store(const Row& row, Scalar* t, int r) {
    std::memcpy(t + static_cast<std::int64_t>(r) * kWidth, &row, sizeof row);
  }
  /// The columns [j, j + n), then what they take from all rows below.
  template <int n>
  LIPOFILL_INLINE void forward_columns(int j, Scalar* t) const {
    Row solved[n];
    for (int c = 0; c < n; ++c) solved[c] = load(t, j + c);
    for (int c = 0; c < n; ++c) {
      solved[c].scale(at(j + c, j + c));
      for (int r = c + 1; r < n; ++r) solved[r].subtract(at(j + r, j + c), solved[c]);
      store(solved[c], t, j + c);
    }
    for (int r = j + n; r < n_rows_; ++r) {
      if (r % kLine == 0) fetch<n>(j, r, ahead(n));
      Row row = load(t, r);
      for (int c = 0; c < n; ++c) row.subtract(at(r, j + c), solved[c]);
      store(row, t, r);
    }
  }

  /// This subtracts what all rows below take from the columns [j, j + n), then those.
  template <int n>
  LIPOFILL_INLINE void backward_columns(int j, Scalar* t) const {
    Row left[n];
    for (int c = 0; c < n; ++c) left[c] = load(t, j + c);
    for (int r = j + n; r < n_rows_; ++r) {
      if (r % kLine == 0) fetch<n>(j, r, -ahead(n));
      const Row row = load(t, r);
      for (int c = 0; c < n; ++c) left[c].subtract(at(r, j + c), row);
    }
    for (int c = n - 1; c >= 0; --c) {
      for (int r = c + 1; r < n; ++r) left[c].subtract(at(j + r, j + c), left[r]);
      left[c].scale(at(j + c, j + c));
      store(left[c], t, j + c);
    }
  }

  const Scalar* panel_;
  int n_rows_;
  int n_columns_;
};

}  // namespace lipofill::coupling
