#include "tests/bench/block_matrix.h"

#include <algorithm>

namespace lipofill::bench {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

int column_size(const Sparse& matrix, int column) {
  return matrix.outerIndexPtr()[column + 1] - matrix.outerIndexPtr()[column];
}

/// Copies the rows of a column, moved down by `offset`, to `place` and returns where they end.
int copy_rows(const Sparse& from, int column, int offset, Sparse& to, int place) {
  const int* rows = from.innerIndexPtr() + from.outerIndexPtr()[column];
  std::transform(rows, rows + column_size(from, column), to.innerIndexPtr() + place,
                 [offset](int row) { return row + offset; });
  return place + column_size(from, column);
}

double* copy_values(const Sparse& from, int column, double* place) {
  const double* values = from.valuePtr() + from.outerIndexPtr()[column];
  return std::copy(values, values + column_size(from, column), place);
}

}  // namespace

BlockMatrix::BlockMatrix(const LinearStep& step, const Sparse& corner) {
  const int n = step.n_dofs();
  lower_.resize(n + step.n_cells(), n + step.n_cells());
  lower_.resizeNonZeros(step.s.nonZeros() + step.b.nonZeros() + corner.nonZeros());
  int place = 0;
  for (int column = 0; column < n; ++column) {
    lower_.outerIndexPtr()[column] = place;
    place = copy_rows(step.s, column, 0, lower_, place);
    place = copy_rows(step.b, column, n, lower_, place);
  }
  for (int cell = 0; cell < step.n_cells(); ++cell) {
    lower_.outerIndexPtr()[n + cell] = place;
    place = copy_rows(corner, cell, n, lower_, place);
  }
  lower_.outerIndexPtr()[n + step.n_cells()] = place;
  fill(step, corner);
}

void BlockMatrix::fill(const LinearStep& step, const Sparse& corner) {
  double* place = lower_.valuePtr();
  for (int column = 0; column < step.n_dofs(); ++column) {
    place = copy_values(step.s, column, place);
    place = copy_values(step.b, column, place);
  }
  for (int cell = 0; cell < step.n_cells(); ++cell) place = copy_values(corner, cell, place);
}

Sparse lower_of_films(const LinearStep& step, double factor) {
  Sparse lower = step.j.triangularView<Eigen::Lower>();
  lower *= factor;
  lower.makeCompressed();
  return lower;
}

Sparse scaled_identity(int n, double factor) {
  Sparse identity(n, n);
  identity.setIdentity();
  identity *= factor;
  return identity;
}

}  // namespace lipofill::bench
