#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

namespace lipofill::coupling {

/// Triangular solves with the columns of a factor, in the time it takes to read it: each column is
/// read once, four side by side, while the next four are on their way. BLAS, which starts anew in
/// every small panel, takes two to three times as long.
///
/// A panel is (n_rows, n_columns), column-major, n_rows >= n_columns: its first n_columns rows are
/// the lower triangle L1, with the reciprocals of its diagonal in place of the diagonal
/// (invert_diagonal), the rows below it L2. Columns are read in whole cache lines, so that kPadding
/// finite values must follow the last one, and kPadding values the n_rows of t. Sums in a fixed
/// order. Checked by tests/unit/coupling/panel_solve_test.cc.
template <typename Scalar>
class PanelSolve {
 public:
  static constexpr int kPadding = 64 / static_cast<int>(sizeof(Scalar));

  PanelSolve(const Scalar* panel, int n_rows, int n_columns) : panel_(panel), n_rows_(n_rows), n_columns_(n_columns) {}

  /// Inverts the diagonal of a panel; to be called once it is factored.
  static void invert_diagonal(Scalar* panel, int n_rows, int n_columns) {
    for (int c = 0; c < n_columns; ++c) {
      Scalar& diagonal = panel[static_cast<std::int64_t>(c) * n_rows + c];
      diagonal = Scalar(1) / diagonal;
    }
  }

  /// [t1; t2] <- [L1^-1 t1; t2 - L2 L1^-1 t1]; what pads t is lost.
  void forward(Scalar* t) const {
    int j = 0;
    for (; j + kSideBySide <= n_columns_; j += kSideBySide) {
      for (int c = j; c < j + kSideBySide; ++c) {
        t[c] *= at(c, c);
        for (int r = c + 1; r < j + kSideBySide; ++r) t[r] -= at(r, c) * t[c];
      }
      subtract<kSideBySide>(j, t);
    }
    for (; j < n_columns_; ++j) {
      t[j] *= at(j, j);
      subtract<1>(j, t);
    }
  }

  /// t1 <- L1^-T (t1 - L2^T t2); what pads t must be zero.
  void backward(Scalar* t) const {
    int j = n_columns_;
    for (; j % kSideBySide != 0; --j) {
      add_up<1>(j - 1, t);
      t[j - 1] *= at(j - 1, j - 1);
    }
    for (; j > 0; j -= kSideBySide) {
      add_up<kSideBySide>(j - kSideBySide, t);
      for (int c = j - 1; c >= j - kSideBySide; --c) {
        for (int r = c + 1; r < j; ++r) t[c] -= at(r, c) * t[r];
        t[c] *= at(c, c);
      }
    }
  }

 private:
  static constexpr int kSideBySide = 4;
  /// Values on their way at least, of this panel and of the next ones: what memory delivers while
  /// it is asked for more.
  static constexpr std::int64_t kAhead = 8192 / sizeof(Scalar);
  using Line = Eigen::Array<Scalar, kPadding, 1>;

  const Scalar* column(int c) const { return panel_ + static_cast<std::int64_t>(c) * n_rows_; }
  Scalar at(int r, int c) const { return column(c)[r]; }

  /// t -= the columns [first, first + n) times their t, in the rows below them.
  template <int n>
  void subtract(int first, Scalar* t) const {
    const Scalar* columns[n];
    Scalar shares[n];
    for (int c = 0; c < n; ++c) {
      columns[c] = column(first + c);
      shares[c] = t[first + c];
    }
    const std::int64_t ahead = std::max<std::int64_t>(n * n_rows_, kAhead);
    for (int r = first + n; r < n_rows_; r += kPadding) {
      Line line = Eigen::Map<Line>(t + r);
      for (int c = 0; c < n; ++c) {
        __builtin_prefetch(columns[c] + r + ahead);
        line -= shares[c] * Eigen::Map<const Line>(columns[c] + r);
      }
      Eigen::Map<Line>(t + r) = line;
    }
  }

  /// t of the columns [first, first + n) -= the columns . t, in the rows below them.
  template <int n>
  void add_up(int first, Scalar* t) const {
    const Scalar* columns[n];
    Line sums[n];
    for (int c = 0; c < n; ++c) {
      columns[c] = column(first + c);
      sums[c].setZero();
    }
    const std::int64_t ahead = std::max<std::int64_t>(n * n_rows_, kAhead);
    for (int r = first + n; r < n_rows_; r += kPadding) {
      const Line line = Eigen::Map<const Line>(t + r);
      for (int c = 0; c < n; ++c) {
        __builtin_prefetch(columns[c] + r - ahead);
        sums[c] += Eigen::Map<const Line>(columns[c] + r) * line;
      }
    }
    for (int c = 0; c < n; ++c) t[first + c] -= sums[c].sum();
  }

  const Scalar* panel_;
  int n_rows_;
  int n_columns_;
};

}  // namespace lipofill::coupling
