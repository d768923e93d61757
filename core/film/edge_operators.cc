#include "core/film/edge_operators.h"

#include <cmath>
#include <vector>

namespace lipofill::film {
namespace {

QuadrantForm conductance_form(const QuadrantMetric& g, const QuadrantEdges& edges, const Eigen::VectorXd& k) {
  QuadrantForm form;
  if (edges.xi >= 0 && edges.eta >= 0) {
    const double scale = 0.25 / g.sqrt_g;
    form.w11 = scale * k[edges.xi] * g.g22;
    form.w22 = scale * k[edges.eta] * g.g11;
    form.w12 = -scale * std::sqrt(k[edges.xi] * k[edges.eta]) * g.g12;
  } else if (edges.xi >= 0) {
    form.w11 = 0.25 * k[edges.xi] * g.sqrt_g / g.g11;
  } else if (edges.eta >= 0) {
    form.w22 = 0.25 * k[edges.eta] * g.sqrt_g / g.g22;
  }
  return form;
}

/// `of_quadrant`: a value a quadrant, four a cell.
template <typename Value, typename Visit>
void for_each_quadrant(const FilmGrid& grid, const std::vector<std::array<Value, 4>>& of_quadrant, Visit visit) {
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    for (int q = 0; q < 4; ++q) visit(of_quadrant[cell][q], quadrant_edges(grid, cell, q));
  }
}

}  // namespace

Eigen::VectorXd compute_edge_difference(const FilmGrid& grid, const Eigen::VectorXd& p) {
  Eigen::VectorXd difference(grid.n_edges());
  for (int e = 0; e < grid.n_edges(); ++e) difference[e] = p[grid.edges[e].right] - p[grid.edges[e].left];
  return difference;
}

Eigen::VectorXd compute_outflow(const FilmGrid& grid, const Eigen::VectorXd& flux) {
  Eigen::VectorXd outflow = Eigen::VectorXd::Zero(grid.n_cells());
  for (int e = 0; e < grid.n_edges(); ++e) {
    outflow[grid.edges[e].left] += flux[e];
    outflow[grid.edges[e].right] -= flux[e];
  }
  return outflow;
}

QuadrantForms compute_conductance_forms(const FilmGrid& grid, const FilmMetric& metric,
                                        const Eigen::VectorXd& conductance) {
  QuadrantForms forms(grid.n_cells());
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    for (int q = 0; q < 4; ++q) {
      forms[cell][q] = conductance_form(metric.quadrants[cell][q], quadrant_edges(grid, cell, q), conductance);
    }
  }
  return forms;
}

Eigen::VectorXd apply_forms(const FilmGrid& grid, const QuadrantForms& forms, const Eigen::VectorXd& difference) {
  Eigen::VectorXd flux = Eigen::VectorXd::Zero(grid.n_edges());
  for_each_quadrant(grid, forms, [&](const QuadrantForm& form, const QuadrantEdges& edges) {
    const double d1 = edges.xi < 0 ? 0.0 : difference[edges.xi];
    const double d2 = edges.eta < 0 ? 0.0 : difference[edges.eta];
    if (edges.xi >= 0) flux[edges.xi] += form.w11 * d1 + form.w12 * d2;
    if (edges.eta >= 0) flux[edges.eta] += form.w12 * d1 + form.w22 * d2;
  });
  return flux;
}

Eigen::VectorXd apply_conductance(const FilmGrid& grid, const FilmMetric& metric, const Eigen::VectorXd& conductance,
                                  const Eigen::VectorXd& difference) {
  return apply_forms(grid, compute_conductance_forms(grid, metric, conductance), difference);
}

PressureOperator::PressureOperator(const FilmGrid& grid) : matrix_(grid.n_cells(), grid.n_cells()) {
  std::vector<Eigen::Triplet<double>> pattern;
  pattern.reserve(9 * static_cast<size_t>(grid.n_cells()));
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    pattern.emplace_back(cell, cell, 0.0);
    for (int q = 0; q < 4; ++q) {
      const int across_xi = grid.neighbour(cell, static_cast<Side>(q & 1));
      const int across_eta = grid.neighbour(cell, static_cast<Side>(2 + (q >> 1)));
      for (const int a : {cell, across_xi, across_eta}) {
        for (const int b : {cell, across_xi, across_eta}) {
          if (a >= 0 && b >= 0) pattern.emplace_back(a, b, 0.0);
        }
      }
    }
  }
  for (const LeakyWall& wall : grid.leaky_walls) {
    pattern.emplace_back(wall.left, wall.right, 0.0);
    pattern.emplace_back(wall.right, wall.left, 0.0);
  }
  matrix_.setFromTriplets(pattern.begin(), pattern.end());
  matrix_.makeCompressed();
}

const Eigen::SparseMatrix<double>& PressureOperator::assemble(const FilmGrid& grid, const FilmMetric& metric,
                                                              const Eigen::VectorXd& conductance) {
  return assemble(grid, compute_conductance_forms(grid, metric, conductance),
                  Eigen::VectorXd::Zero(static_cast<Eigen::Index>(grid.leaky_walls.size())));
}

const Eigen::SparseMatrix<double>& PressureOperator::assemble(const FilmGrid& grid, const QuadrantForms& forms,
                                                              const Eigen::VectorXd& leaks) {
  matrix_.coeffs().setZero();
  const auto add_between = [&](const auto& a, const auto& b, double w) {
    matrix_.coeffRef(a.left, b.left) += w;
    matrix_.coeffRef(a.right, b.right) += w;
    matrix_.coeffRef(a.left, b.right) -= w;
    matrix_.coeffRef(a.right, b.left) -= w;
  };
  const auto add = [&](int a, int b, double w) { add_between(grid.edges[a], grid.edges[b], w); };
  for_each_quadrant(grid, forms, [&](const QuadrantForm& form, const QuadrantEdges& edges) {
    if (edges.xi >= 0) add(edges.xi, edges.xi, form.w11);
    if (edges.eta >= 0) add(edges.eta, edges.eta, form.w22);
    if (edges.xi >= 0 && edges.eta >= 0) {
      add(edges.xi, edges.eta, form.w12);
      add(edges.eta, edges.xi, form.w12);
    }
  });
  for (size_t k = 0; k < grid.leaky_walls.size(); ++k) {
    add_between(grid.leaky_walls[k], grid.leaky_walls[k], leaks[static_cast<Eigen::Index>(k)]);
  }
  return matrix_;
}

Eigen::SparseMatrix<double> assemble_velocity_mass(const FilmGrid& grid, const FilmMetric& metric,
                                                   const Eigen::VectorXd& weight) {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(16 * static_cast<size_t>(grid.n_cells()));
  for_each_quadrant(grid, metric.quadrants, [&](const QuadrantMetric& g, const QuadrantEdges& edges) {
    const double scale = 0.25 / g.sqrt_g;
    if (edges.xi >= 0) triplets.emplace_back(edges.xi, edges.xi, scale * weight[edges.xi] * g.g11);
    if (edges.eta >= 0) triplets.emplace_back(edges.eta, edges.eta, scale * weight[edges.eta] * g.g22);
    if (edges.xi < 0 || edges.eta < 0) return;
    const double cross = scale * std::sqrt(weight[edges.xi] * weight[edges.eta]) * g.g12;
    triplets.emplace_back(edges.xi, edges.eta, cross);
    triplets.emplace_back(edges.eta, edges.xi, cross);
  });
  Eigen::SparseMatrix<double> mass(grid.n_edges(), grid.n_edges());
  mass.setFromTriplets(triplets.begin(), triplets.end());
  return mass;
}

Eigen::Matrix3Xd compute_cell_velocity(const FilmGrid& grid, const FilmMetric& metric,
                                       const Eigen::VectorXd& edge_velocity) {
  Eigen::Matrix3Xd velocity(3, grid.n_cells());
  const auto value = [&](int edge) { return edge < 0 ? 0.0 : edge_velocity[edge]; };
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    const int i = grid.slot_i(grid.slot_of_cell[cell]);
    const int j = grid.slot_j(grid.slot_of_cell[cell]);
    const auto x = [&](int di, int dj) { return metric.vertices.col(grid.vertex(i + di, j + dj)); };
    const Eigen::Vector3d g1 = 0.5 * (x(1, 0) - x(0, 0) + x(1, 1) - x(0, 1));
    const Eigen::Vector3d g2 = 0.5 * (x(0, 1) - x(0, 0) + x(1, 1) - x(1, 0));
    const auto& sides = grid.edge_of_side[cell];
    const double u1 = 0.5 * (value(sides[kLowXi]) + value(sides[kHighXi]));
    const double u2 = 0.5 * (value(sides[kLowEta]) + value(sides[kHighEta]));
    velocity.col(cell) = (u1 * g1 + u2 * g2) / metric.area[cell];
  }
  return velocity;
}

}  // namespace lipofill::film
