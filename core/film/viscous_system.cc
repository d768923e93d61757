#include "core/film/viscous_system.h"

#include <algorithm>

namespace lipofill::film {
namespace {

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

}  // namespace

ViscousSystem::ViscousSystem(const FilmGrid& grid) {
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      const std::array<int, 4> cells = cells_around(grid, i, j);
      if (*std::min_element(cells.begin(), cells.end()) < 0) continue;
      const InnerVertex vertex{cells,
                               grid.edge_of_side[cells[0]][kHighXi],
                               grid.edge_of_side[cells[1]][kHighEta],
                               grid.edge_of_side[cells[2]][kHighXi],
                               grid.edge_of_side[cells[0]][kHighEta],
                               0.0};
      if (std::min({vertex.low, vertex.right, vertex.high, vertex.left}) >= 0) vertices_.push_back(vertex);
    }
  }
}

void ViscousSystem::set(const FilmGrid& grid, const FilmMetric& metric, const Eigen::VectorXd& edge_weight,
                        const Eigen::VectorXd& cell_thickness, double diffusion) {
  scale_forms(grid, unit_mass_, edge_weight, root_, weighted_mass_);
  over_area_ = diffusion * cell_thickness.cwiseQuotient(metric.area);
  set_vertices(metric, cell_thickness, diffusion);
  set_diagonal(grid);
}

void ViscousSystem::set_vertices(const FilmMetric& metric, const Eigen::VectorXd& cell_thickness, double diffusion) {
  for (InnerVertex& vertex : vertices_) {
    double area = 0.0;
    double volume = 0.0;
    for (int q = 0; q < 4; ++q) {
      const int cell = vertex.cells[q];
      const double quarter = 0.25 * metric.quadrants[cell][3 - q].sqrt_g;
      area += quarter;
      volume += quarter * cell_thickness[cell];
    }
    vertex.thickness_over_area = diffusion * volume / (area * area);
  }
}

/// Sets the diagonals of the system and of the momentum; the last term takes only the diagonal of
/// M(1).
void ViscousSystem::set_diagonal(const FilmGrid& grid) {
  diagonal_.setZero(grid.n_edges());
  momentum_.setZero(grid.n_edges());
  double* const of_system = diagonal_.data();
  double* const of_mass = momentum_.data();
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    for (int q = 0; q < 4; ++q) {
      const QuadrantEdges edges = quadrant_edges(grid, cell, q);
      if (edges.xi >= 0) of_system[edges.xi] += weighted_mass_[cell][q].w11;
      if (edges.xi >= 0) of_mass[edges.xi] += unit_mass_[cell][q].w11;
      if (edges.eta >= 0) of_system[edges.eta] += weighted_mass_[cell][q].w22;
      if (edges.eta >= 0) of_mass[edges.eta] += unit_mass_[cell][q].w22;
    }
  }
  for (int e = 0; e < grid.n_edges(); ++e) {
    of_system[e] += over_area_[grid.edges[e].left] + over_area_[grid.edges[e].right];
  }
  for (const InnerVertex& vertex : vertices_) {
    for (const int e : {vertex.low, vertex.right, vertex.high, vertex.left}) {
      of_system[e] += vertex.thickness_over_area * of_mass[e] * of_mass[e];
    }
  }
}

void ViscousSystem::multiply(const FilmGrid& grid, const Eigen::VectorXd& u, Eigen::VectorXd& product) {
  product.setZero(grid.n_edges());
  add_flux_of_forms(grid, weighted_mass_, u, product);

  compute_outflow(grid, u, outflow_);
  outflow_.array() *= over_area_.array();
  for (int e = 0; e < grid.n_edges(); ++e) {
    product.data()[e] += outflow_.data()[grid.edges[e].left] - outflow_.data()[grid.edges[e].right];
  }

  momentum_.setZero(grid.n_edges());
  add_flux_of_forms(grid, unit_mass_, u, momentum_);
  curl_.setZero(grid.n_edges());
  double* const curl = curl_.data();
  for (const InnerVertex& v : vertices_) {
    const double* m = momentum_.data();
    const double circulation = v.thickness_over_area * (m[v.low] + m[v.right] - m[v.high] - m[v.left]);
    curl[v.low] += circulation;
    curl[v.right] += circulation;
    curl[v.high] -= circulation;
    curl[v.left] -= circulation;
  }
  add_flux_of_forms(grid, unit_mass_, curl_, product);
}

}  // namespace lipofill::film
