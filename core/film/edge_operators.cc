#include "core/film/edge_operators.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lipofill::film {
namespace {

/// The fat of a quarter that the outline cuts is as fast as the flux demands; below this share the
/// estimate is kept from growing without bound.
constexpr double kLeastShareOfInertia = 0.1;

QuadrantForm unit_form(const QuadrantMetric& g, const QuadrantEdges& edges) {
  QuadrantForm form;
  if (edges.xi >= 0 && edges.eta >= 0) {
    const double scale = 0.25 * g.share / g.sqrt_g;
    form = {scale * g.g22, -scale * g.g12, scale * g.g11};
  } else if (edges.xi >= 0) {
    form.w11 = 0.25 * g.share * g.sqrt_g / g.g11;
  } else if (edges.eta >= 0) {
    form.w22 = 0.25 * g.share * g.sqrt_g / g.g22;
  }
  return form;
}

QuadrantForm unit_mass_form(const QuadrantMetric& g, const QuadrantEdges& edges) {
  const double scale = 0.25 / (std::max(g.share, kLeastShareOfInertia) * g.sqrt_g);
  const bool both = edges.xi >= 0 && edges.eta >= 0;
  return {edges.xi >= 0 ? scale * g.g11 : 0.0, both ? scale * g.g12 : 0.0, edges.eta >= 0 ? scale * g.g22 : 0.0};
}

/// Visits the quadrants of every cell with the edges they touch.
template <typename Visit>
void for_each_quadrant(const FilmGrid& grid, Visit visit) {
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    for (int q = 0; q < 4; ++q) visit(cell, q, quadrant_edges(grid, cell, q));
  }
}

/// 0 where the edge is sealed.
double at(const double* values, int edge) {
  return edge < 0 ? 0.0 : values[edge];
}

}  // namespace

void compute_edge_difference(const FilmGrid& grid, const Values& p, Eigen::VectorXd& difference) {
  difference.resize(grid.n_edges());
  const double* of_cell = p.data();
  double* of_edge = difference.data();
  for (const Edge& edge : grid.edges) *of_edge++ = of_cell[edge.right] - of_cell[edge.left];
}

Eigen::VectorXd compute_edge_difference(const FilmGrid& grid, const Values& p) {
  Eigen::VectorXd difference;
  compute_edge_difference(grid, p, difference);
  return difference;
}

void compute_outflow(const FilmGrid& grid, const Values& flux, Eigen::VectorXd& outflow) {
  outflow.setZero(grid.n_cells());
  const double* of_edge = flux.data();
  double* of_cell = outflow.data();
  for (const Edge& edge : grid.edges) {
    of_cell[edge.left] += *of_edge;
    of_cell[edge.right] -= *of_edge++;
  }
}

Eigen::VectorXd compute_outflow(const FilmGrid& grid, const Values& flux) {
  Eigen::VectorXd outflow;
  compute_outflow(grid, flux, outflow);
  return outflow;
}

void compute_unit_forms(const FilmGrid& grid, const FilmMetric& metric, QuadrantForms& unit) {
  unit.resize(grid.n_cells());
  for_each_quadrant(grid, [&](int cell, int q, const QuadrantEdges& edges) {
    unit[cell][q] = unit_form(metric.quadrants[cell][q], edges);
  });
}

void compute_unit_mass_forms(const FilmGrid& grid, const FilmMetric& metric, QuadrantForms& unit) {
  unit.resize(grid.n_cells());
  for_each_quadrant(grid, [&](int cell, int q, const QuadrantEdges& edges) {
    unit[cell][q] = unit_mass_form(metric.quadrants[cell][q], edges);
  });
}

void scale_forms(const FilmGrid& grid, const QuadrantForms& unit, const Eigen::VectorXd& k, Eigen::VectorXd& root,
                 QuadrantForms& forms) {
  root = k.cwiseSqrt();
  forms.resize(unit.size());
  for_each_quadrant(grid, [&, k = k.data(), root = root.data()](int cell, int q, const QuadrantEdges& edges) {
    const QuadrantForm& u = unit[cell][q];
    forms[cell][q] = {at(k, edges.xi) * u.w11, at(root, edges.xi) * at(root, edges.eta) * u.w12,
                      at(k, edges.eta) * u.w22};
  });
}

void add_flux_of_forms(const FilmGrid& grid, const QuadrantForms& forms, const Eigen::VectorXd& difference,
                       Eigen::Ref<Eigen::VectorXd> flux) {
  for_each_quadrant(grid, [&, d = difference.data(), f = flux.data()](int cell, int q, const QuadrantEdges& edges) {
    const QuadrantForm& form = forms[cell][q];
    const double d1 = at(d, edges.xi);
    const double d2 = at(d, edges.eta);
    if (edges.xi >= 0) f[edges.xi] += form.w11 * d1 + form.w12 * d2;
    if (edges.eta >= 0) f[edges.eta] += form.w12 * d1 + form.w22 * d2;
  });
}

Eigen::VectorXd apply_forms(const FilmGrid& grid, const QuadrantForms& forms, const Eigen::VectorXd& difference) {
  Eigen::VectorXd flux = Eigen::VectorXd::Zero(grid.n_edges());
  add_flux_of_forms(grid, forms, difference, flux);
  return flux;
}

Eigen::VectorXd apply_conductance(const FilmGrid& grid, const FilmMetric& metric, const Eigen::VectorXd& conductance,
                                  const Eigen::VectorXd& difference) {
  QuadrantForms unit, forms;
  Eigen::VectorXd root;
  compute_unit_forms(grid, metric, unit);
  scale_forms(grid, unit, conductance, root, forms);
  return apply_forms(grid, forms, difference);
}

Eigen::Matrix3Xd compute_cell_velocity(const FilmGrid& grid, const FilmMetric& metric,
                                       const Eigen::VectorXd& edge_velocity) {
  Eigen::Matrix3Xd velocity(3, grid.n_cells());
  const double* u = edge_velocity.data();
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    const int i = grid.slot_i(grid.slot_of_cell[cell]);
    const int j = grid.slot_j(grid.slot_of_cell[cell]);
    const auto x = [&](int di, int dj) { return metric.vertices.col(grid.vertex(i + di, j + dj)); };
    const Eigen::Vector3d g1 = 0.5 * (x(1, 0) - x(0, 0) + x(1, 1) - x(0, 1));
    const Eigen::Vector3d g2 = 0.5 * (x(0, 1) - x(0, 0) + x(1, 1) - x(1, 0));
    const auto& sides = grid.edge_of_side[cell];
    const double u1 = 0.5 * (at(u, sides[kLowXi]) + at(u, sides[kHighXi]));
    const double u2 = 0.5 * (at(u, sides[kLowEta]) + at(u, sides[kHighEta]));
    velocity.col(cell) = (u1 * g1 + u2 * g2) / metric.area[cell];
  }
  return velocity;
}

}  // namespace lipofill::film
