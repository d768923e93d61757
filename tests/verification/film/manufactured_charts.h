#pragma once

// Charts that are not orthogonal, and what the calculus of surfaces says on them: the references
// that the film's operators are held against. Everything here works on analytic fields of the chart
// coordinates and shares nothing with the operators. Derivatives are central differences of fourth
// order over a thousandth of the chart: they are good to 1e-9 a level, 1e-6 where three are nested.

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "core/film/film_grid.h"
#include "core/film/film_metric.h"

namespace lipofill::verification {

using Field = std::function<double(double xi, double eta)>;
/// sqrt(g) u^a: what crosses lines of constant xi and of constant eta, a unit of the other
/// coordinate.
using FluxDensity = std::function<Eigen::Vector2d(double xi, double eta)>;

/// A surface over the unit square. On charts with `natural_walls` these are lines of constant x or
/// y, which cross at right angles there although those of xi and eta do not: the gradient of a
/// product of cosines does not go through them.
struct Chart {
  std::string name;
  std::function<Eigen::Vector2d(double xi, double eta)> plane;  ///< maps to the surface's own coordinates x, y
  std::function<Eigen::Vector3d(double x, double y)> surface;
  bool natural_walls = false;

  Eigen::Vector3d point(double xi, double eta) const;
  /// Place of a point in the rectangle of x and y, scaled to the unit square.
  Eigen::Vector2d unit_place(double xi, double eta) const;
  /// A field of that place as one of xi, eta.
  Field pull_back(const Field& of_place) const;
};

/// A parallelogram, a plane of varying angle, a stretched rectangle, a cylinder, a sphere and a
/// bumpy surface; the last three with lines of xi and eta that cross at varying angles.
const std::vector<Chart>& charts();

double d_xi(const Field& f, double xi, double eta);
double d_eta(const Field& f, double xi, double eta);

/// Tangents, metric and its inverse at a point.
struct Tangents {
  Eigen::Vector3d g1;
  Eigen::Vector3d g2;
  Eigen::Matrix2d covariant;
  double sqrt_g = 0.0;
};
Tangents tangents_at(const Chart& chart, double xi, double eta);

/// Gradient as a vector of space.
Eigen::Vector3d gradient(const Chart& chart, const Field& p, double xi, double eta);
/// sqrt(g) g^ab d_b p.
Eigen::Vector2d gradient_flux(const Chart& chart, const Field& p, double xi, double eta);
/// (d_1 q^1 + d_2 q^2) / sqrt(g).
double divergence(const Chart& chart, const FluxDensity& q, double xi, double eta);
/// (d_1 u_2 - d_2 u_1) / sqrt(g), u_a = g_ab q^b / sqrt(g).
double curl(const Chart& chart, const FluxDensity& q, double xi, double eta);

/// Vanishes on all walls with its first three derivatives.
double still_at_walls(double xi, double eta);

film::FilmGrid make_grid(int n);
film::FilmMetric make_metric(const Chart& chart, const film::FilmGrid& grid);
Eigen::VectorXd sample_at_cells(const film::FilmGrid& grid, const Field& f);
Eigen::VectorXd sample_at_edges(const film::FilmGrid& grid, const Field& f);
/// Flux through every open edge by Gauss quadrature with three points.
Eigen::VectorXd integrate_over_edges(const film::FilmGrid& grid, const FluxDensity& q);
/// Chart coordinates of a cell's centre.
Eigen::Vector2d centre_of(const film::FilmGrid& grid, int cell);

/// |a - b| / |b| in the L2 norm over the surface.
double cell_error(const film::FilmMetric& metric, const Eigen::VectorXd& a, const Eigen::VectorXd& b);
/// The same of edge fluxes, each with the same weight: the L2 norm over the chart.
double edge_error(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

}  // namespace lipofill::verification
