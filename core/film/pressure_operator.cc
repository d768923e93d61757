// The film's J: where its values are is found once, what they are is summed cell by cell.

#include <algorithm>
#include <vector>

#include "core/film/edge_operators.h"

namespace lipofill::film {
namespace {

/// Sign of w12 for a quadrant at corner (s, t) when differences are taken as neighbour less cell;
/// it is that of both differences along +xi and +eta at high-high and low-low corners.
constexpr double kCrossSign[4] = {1.0, -1.0, -1.0, 1.0};

}  // namespace

PressureOperator::PressureOperator(const FilmGrid& grid) : matrix_(grid.n_cells(), grid.n_cells()) {
  build_pattern(grid);
  for (int cell = 0; cell < grid.n_cells(); ++cell) cells_.push_back(find_slots(grid, cell));
  for (const LeakyWall& wall : grid.leaky_walls) {
    leaks_.push_back({slot(wall.left, wall.left), slot(wall.right, wall.right), slot(wall.left, wall.right),
                      slot(wall.right, wall.left)});
  }
}

void PressureOperator::build_pattern(const FilmGrid& grid) {
  std::vector<Eigen::Triplet<double>> pattern;
  pattern.reserve(21 * static_cast<size_t>(grid.n_cells()));
  const auto couple = [&pattern](int a, int b) {
    if (a < 0 || b < 0) return;
    pattern.emplace_back(a, b, 0.0);
    pattern.emplace_back(b, a, 0.0);
  };
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    pattern.emplace_back(cell, cell, 0.0);
    for (int side = 0; side < 4; ++side) couple(cell, grid.neighbour(cell, static_cast<Side>(side)));
    for (int q = 0; q < 4; ++q) {
      couple(grid.neighbour(cell, static_cast<Side>(q & 1)), grid.neighbour(cell, static_cast<Side>(2 + (q >> 1))));
    }
  }
  for (const LeakyWall& wall : grid.leaky_walls) couple(wall.left, wall.right);
  matrix_.setFromTriplets(pattern.begin(), pattern.end());
  matrix_.makeCompressed();
}

std::int32_t PressureOperator::slot(int row, int column) const {
  const int* rows = matrix_.innerIndexPtr();
  const int* begin = rows + matrix_.outerIndexPtr()[column];
  const int* end = rows + matrix_.outerIndexPtr()[column + 1];
  return static_cast<std::int32_t>(std::lower_bound(begin, end, row) - rows);
}

PressureOperator::CellSlots PressureOperator::find_slots(const FilmGrid& grid, int cell) const {
  const auto find = [&](int row, int column) { return row < 0 || column < 0 ? slot(cell, cell) : slot(row, column); };
  CellSlots slots;
  slots.diagonal = slot(cell, cell);
  for (int side = 0; side < 4; ++side) {
    const int neighbour = grid.neighbour(cell, static_cast<Side>(side));
    slots.neighbour_diagonal[side] = find(neighbour, neighbour);
    slots.with_neighbour[side][0] = find(cell, neighbour);
    slots.with_neighbour[side][1] = find(neighbour, cell);
  }
  for (int q = 0; q < 4; ++q) {
    const int across_xi = grid.neighbour(cell, static_cast<Side>(q & 1));
    const int across_eta = grid.neighbour(cell, static_cast<Side>(2 + (q >> 1)));
    slots.between_neighbours[q][0] = find(across_xi, across_eta);
    slots.between_neighbours[q][1] = find(across_eta, across_xi);
  }
  return slots;
}

const Eigen::SparseMatrix<double>& PressureOperator::assemble(const FilmGrid& grid, const FilmMetric& metric,
                                                              const Eigen::VectorXd& conductance) {
  QuadrantForms unit, forms;
  Eigen::VectorXd root;
  compute_unit_forms(grid, metric, unit);
  scale_forms(grid, unit, conductance, root, forms);
  return assemble(forms, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(leaks_.size())), 1.0);
}

const Eigen::SparseMatrix<double>& PressureOperator::assemble(const QuadrantForms& forms, const Eigen::VectorXd& leaks,
                                                              double factor) {
  matrix_.coeffs().setZero();
  double* const values = matrix_.valuePtr();
  for (size_t cell = 0; cell < cells_.size(); ++cell) {
    const CellSlots& slots = cells_[cell];
    double own = 0.0;
    double across[4] = {};       // squares of the differences, by Side
    double with_others[4] = {};  // their products with those along the other direction
    for (int q = 0; q < 4; ++q) {
      const QuadrantForm& form = forms[cell][q];
      const double w12 = factor * kCrossSign[q] * form.w12;
      across[q & 1] += factor * form.w11;
      across[2 + (q >> 1)] += factor * form.w22;
      with_others[q & 1] += w12;
      with_others[2 + (q >> 1)] += w12;
      own += 2.0 * w12;
      values[slots.between_neighbours[q][0]] += w12;
      values[slots.between_neighbours[q][1]] += w12;
    }
    for (int side = 0; side < 4; ++side) {
      own += across[side];
      values[slots.neighbour_diagonal[side]] += across[side];
      values[slots.with_neighbour[side][0]] -= across[side] + with_others[side];
      values[slots.with_neighbour[side][1]] -= across[side] + with_others[side];
    }
    values[slots.diagonal] += own;
  }
  for (size_t k = 0; k < leaks_.size(); ++k) {
    const double leak = factor * leaks[static_cast<Eigen::Index>(k)];
    values[leaks_[k].left] += leak;
    values[leaks_[k].right] += leak;
    values[leaks_[k].left_right] -= leak;
    values[leaks_[k].right_left] -= leak;
  }
  return matrix_;
}

}  // namespace lipofill::film
