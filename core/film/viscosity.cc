#include "core/film/viscosity.h"

#include <algorithm>
#include <vector>

#include "core/film/edge_operators.h"

namespace lipofill::film {
namespace {

/// Keeps the system regular on dry edges, whose velocity is set to zero afterwards [m].
constexpr double kThinnest = 1e-7;

Eigen::SparseMatrix<double> make_outflow_matrix(const FilmGrid& grid) {
  std::vector<Eigen::Triplet<double>> triplets;
  for (int e = 0; e < grid.n_edges(); ++e) {
    triplets.emplace_back(grid.edges[e].left, e, 1.0);
    triplets.emplace_back(grid.edges[e].right, e, -1.0);
  }
  Eigen::SparseMatrix<double> matrix(grid.n_cells(), grid.n_edges());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

/// Cells around vertex (i, j), by (side of xi) + 2 (side of eta); -1 where there is none.
std::array<int, 4> cells_around(const FilmGrid& grid, int i, int j) {
  std::array<int, 4> cells = {-1, -1, -1, -1};
  for (int q = 0; q < 4; ++q) {
    const int ci = i - 1 + (q & 1);
    const int cj = j - 1 + (q >> 1);
    if (ci < 0 || cj < 0 || ci >= grid.n_xi || cj >= grid.n_eta) continue;
    cells[q] = grid.cell_of_slot[cj * grid.n_xi + ci];
  }
  return cells;
}

Eigen::SparseMatrix<double> make_circulation_matrix(const FilmGrid& grid) {
  std::vector<Eigen::Triplet<double>> triplets;
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      const std::array<int, 4> cells = cells_around(grid, i, j);
      if (std::min({cells[0], cells[1], cells[2], cells[3]}) < 0) continue;
      const int low = grid.edge_of_side[cells[0]][kHighXi];
      const int right = grid.edge_of_side[cells[1]][kHighEta];
      const int high = grid.edge_of_side[cells[2]][kHighXi];
      const int left = grid.edge_of_side[cells[0]][kHighEta];
      if (std::min({low, right, high, left}) < 0) continue;
      const int vertex = grid.vertex(i, j);
      triplets.emplace_back(vertex, low, 1.0);
      triplets.emplace_back(vertex, right, 1.0);
      triplets.emplace_back(vertex, high, -1.0);
      triplets.emplace_back(vertex, left, -1.0);
    }
  }
  Eigen::SparseMatrix<double> matrix(grid.n_vertices(), grid.n_edges());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

/// Thickness over area of the dual cell of every vertex, the mean of the cells around it.
Eigen::VectorXd vertex_thickness_over_area(const FilmGrid& grid, const FilmMetric& metric, const Eigen::VectorXd& h) {
  Eigen::VectorXd area = Eigen::VectorXd::Zero(grid.n_vertices());
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(grid.n_vertices());
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    const int slot = grid.slot_of_cell[cell];
    for (int q = 0; q < 4; ++q) {
      const int vertex = grid.vertex(grid.slot_i(slot) + (q & 1), grid.slot_j(slot) + (q >> 1));
      const double quarter = 0.25 * metric.quadrants[cell][q].sqrt_g;
      area[vertex] += quarter;
      volume[vertex] += quarter * h[cell];
    }
  }
  return (area.array() > 0.0).select(volume.array() / area.array().square().max(1e-300), 0.0);
}

}  // namespace

ImplicitViscosity::ImplicitViscosity(const FilmGrid& grid)
    : outflow_(make_outflow_matrix(grid)), circulation_(make_circulation_matrix(grid)) {}

Eigen::VectorXd ImplicitViscosity::advance(const FilmGrid& grid, const FilmMetric& metric, const Fat& fat,
                                           const Eigen::VectorXd& cell_thickness, const Eigen::VectorXd& edge_thickness,
                                           const Eigen::VectorXd& velocity, double dt) {
  const Eigen::VectorXd h = edge_thickness.cwiseMax(kThinnest);
  Eigen::VectorXd damped(h.size());
  for (int e = 0; e < h.size(); ++e) damped[e] = h[e] * (1.0 + dt * compute_friction_rate(fat, h[e]));

  using Sparse = Eigen::SparseMatrix<double>;
  const Sparse unit_mass = assemble_velocity_mass(grid, metric, Eigen::VectorXd::Ones(grid.n_edges()));
  const Sparse mass = assemble_velocity_mass(grid, metric, h);
  const Sparse curl = circulation_ * unit_mass;
  const Eigen::VectorXd over_area = cell_thickness.cwiseQuotient(metric.area);
  const Eigen::VectorXd over_vertex_area = vertex_thickness_over_area(grid, metric, cell_thickness);
  const double scale = dt * fat.viscosity / fat.density;
  Sparse system = assemble_velocity_mass(grid, metric, damped);
  system += scale * Sparse(outflow_.transpose() * over_area.asDiagonal() * outflow_);
  system += scale * Sparse(curl.transpose() * over_vertex_area.asDiagonal() * curl);

  const Eigen::SimplicialLDLT<Sparse> factor(system);
  Eigen::VectorXd next = factor.solve(mass * velocity);
  return (edge_thickness.array() > 0.0).select(next, 0.0);
}

}  // namespace lipofill::film
