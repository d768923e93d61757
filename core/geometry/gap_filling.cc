#include "core/geometry/gap_filling.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/node_values.h"
#include "core/geometry/surface_chart.h"

namespace lipofill::geometry {
namespace {

/// Weights of samples less than this are round-off of a node that lies on another sample.
constexpr double kNoWeight = 1e-9;

/// Neighbours of a node in the grid, at most four.
template <typename Visit>
void for_neighbours(const LayeredGrid& grid, int i, int j, const Visit& visit) {
  if (i > 0) visit(grid.surface_index(i - 1, j));
  if (i < grid.n_xi) visit(grid.surface_index(i + 1, j));
  if (j > 0) visit(grid.surface_index(i, j - 1));
  if (j < grid.n_eta) visit(grid.surface_index(i, j + 1));
}

/// Solves sum over neighbours (c - c_neighbour) + decay c = 0 at every value that is not finite.
/// With one finite value at least, or a decay, the system is positive definite: the grid is
/// connected.
void solve_in_gaps(const LayeredGrid& grid, double decay, Eigen::VectorXd& values) {
  std::vector<int> unknown(values.size(), -1);
  int n_unknown = 0;
  for (Eigen::Index node = 0; node < values.size(); ++node) {
    if (!std::isfinite(values[node])) unknown[node] = n_unknown++;
  }
  if (n_unknown == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n_unknown);
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      const int row = unknown[grid.surface_index(i, j)];
      if (row < 0) continue;
      if (decay > 0.0) entries.emplace_back(row, row, decay);
      for_neighbours(grid, i, j, [&](int neighbour) {
        entries.emplace_back(row, row, 1.0);
        if (unknown[neighbour] < 0) {
          right[row] += values[neighbour];
        } else {
          entries.emplace_back(row, unknown[neighbour], -1.0);
        }
      });
    }
  }
  Eigen::SparseMatrix<double> matrix(n_unknown, n_unknown);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd filled = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
  for (Eigen::Index node = 0; node < values.size(); ++node) {
    if (unknown[node] >= 0) values[node] = filled[unknown[node]];
  }
}

}  // namespace

void fill_harmonically(const LayeredGrid& grid, Eigen::VectorXd& values) {
  if (values.array().isFinite().any()) solve_in_gaps(grid, 0.0, values);
}

void fill_towards(const LayeredGrid& grid, const Eigen::VectorXd& general, double length, Eigen::VectorXd& values) {
  const Eigen::Vector2d spacing =
      compute_mean_spacing(grid.n_xi, grid.n_eta, grid.nodes.leftCols(grid.nodes_per_level()));
  const double ratio = spacing.mean() / length;
  Eigen::VectorXd difference = values - general;
  solve_in_gaps(grid, ratio * ratio, difference);
  for (Eigen::Index node = 0; node < values.size(); ++node) {
    if (!std::isfinite(values[node])) values[node] = general[node] + difference[node];
  }
}

bool has_gaps(const ScalarField& field) {
  return std::any_of(field.values.begin(), field.values.end(), [](double value) { return std::isnan(value); });
}

ScalarField without_gaps(const ScalarField& field) {
  double sum = 0.0;
  int count = 0;
  for (const double value : field.values) {
    if (std::isnan(value)) continue;
    sum += value;
    ++count;
  }
  if (count == 0) return field;
  ScalarField filled = field;
  for (double& value : filled.values) {
    if (std::isnan(value)) value = sum / count;
  }
  return filled;
}

Eigen::VectorXd sample_with_gaps(const ScalarField& field, const LayeredGrid& grid) {
  ScalarField known = field;
  for (double& value : known.values) value = std::isnan(value) ? 0.0 : 1.0;
  Eigen::VectorXd values = sample_at_nodes(without_gaps(field), grid);
  const Eigen::VectorXd share = sample_at_nodes(known, grid);
  for (Eigen::Index node = 0; node < values.size(); ++node) {
    if (share[node] < 1.0 - kNoWeight) values[node] = std::numeric_limits<double>::quiet_NaN();
  }
  return values;
}

}  // namespace lipofill::geometry
