#include "tests/verification/film/manufactured_charts.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace lipofill::verification {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;
constexpr double kStep = 1e-3;

template <typename F>
auto difference(const F& f) -> std::decay_t<decltype(f(0.0))> {
  return (8.0 * (f(kStep) - f(-kStep)) - (f(2.0 * kStep) - f(-2.0 * kStep))) / (12.0 * kStep);
}

/// Keeps the walls of the unit square in place and turns the lines inside it, up to 30 degrees at
/// the walls.
Vector2d warp(double xi, double eta) {
  return {xi - 0.3 * std::sin(kPi * xi) * (eta - 0.5), eta + 0.35 * std::sin(kPi * eta) * (xi - 0.5)};
}

Vector3d plane_of(double x, double y) {
  return {x, y, 0.0};
}

Vector3d cylinder(double x, double y) {
  const double radius = 0.6;
  return {radius * std::sin(x / radius), y, radius * std::cos(x / radius)};
}

/// Longitude x, latitude y - 1/2.
Vector3d sphere(double x, double y) {
  const double latitude = y - 0.5;
  return {std::sin(x) * std::cos(latitude), std::sin(latitude), std::cos(x) * std::cos(latitude)};
}

Vector3d bumps(double x, double y) {
  return {x, y, 0.12 * std::cos(2.0 * kPi * x) * std::cos(kPi * y)};
}

std::vector<Chart> make_charts() {
  const auto parallelogram = [](double xi, double eta) { return Vector2d(xi + 0.6 * eta, 0.8 * eta); };
  const auto varying_angle = [](double xi, double eta) {
    return Vector2d(xi + 0.5 * eta * eta, eta + 0.2 * std::sin(2.0 * xi));
  };
  const auto stretched = [](double xi, double eta) {
    return Vector2d(std::expm1(1.5 * xi) / 1.5, eta - 0.1 * std::sin(2.0 * kPi * eta));
  };
  return {{"parallelogram", parallelogram, plane_of, false},
          {"varying angle", varying_angle, plane_of, false},
          {"stretched", stretched, plane_of, true},
          {"cylinder", warp, cylinder, true},
          {"sphere", warp, sphere, true},
          {"bumps", warp, bumps, true}};
}

/// Contravariant components, times sqrt(g), of a covector.
Vector2d raise(const Tangents& t, const Vector2d& covector) {
  return t.sqrt_g * (t.covariant.inverse() * covector);
}

}  // namespace

Vector3d Chart::point(double xi, double eta) const {
  const Vector2d at = plane(xi, eta);
  return surface(at.x(), at.y());
}

Vector2d Chart::unit_place(double xi, double eta) const {
  const Vector2d low = plane(0, 0);
  return (plane(xi, eta) - low).cwiseQuotient(plane(1, 1) - low);
}

Field Chart::pull_back(const Field& of_place) const {
  return [chart = *this, of_place](double xi, double eta) {
    const Vector2d at = chart.unit_place(xi, eta);
    return of_place(at.x(), at.y());
  };
}

const std::vector<Chart>& charts() {
  static const std::vector<Chart> all = make_charts();
  return all;
}

double d_xi(const Field& f, double xi, double eta) {
  return difference([&](double s) { return f(xi + s, eta); });
}

double d_eta(const Field& f, double xi, double eta) {
  return difference([&](double s) { return f(xi, eta + s); });
}

Tangents tangents_at(const Chart& chart, double xi, double eta) {
  Tangents t;
  t.g1 = difference([&](double s) { return Vector3d(chart.point(xi + s, eta)); });
  t.g2 = difference([&](double s) { return Vector3d(chart.point(xi, eta + s)); });
  t.covariant << t.g1.dot(t.g1), t.g1.dot(t.g2), t.g1.dot(t.g2), t.g2.dot(t.g2);
  t.sqrt_g = t.g1.cross(t.g2).norm();
  return t;
}

Vector2d gradient_flux(const Chart& chart, const Field& p, double xi, double eta) {
  return raise(tangents_at(chart, xi, eta), {d_xi(p, xi, eta), d_eta(p, xi, eta)});
}

Vector3d gradient(const Chart& chart, const Field& p, double xi, double eta) {
  const Tangents t = tangents_at(chart, xi, eta);
  const Vector2d q = raise(t, {d_xi(p, xi, eta), d_eta(p, xi, eta)}) / t.sqrt_g;
  return q.x() * t.g1 + q.y() * t.g2;
}

double divergence(const Chart& chart, const FluxDensity& q, double xi, double eta) {
  const double d1 = difference([&](double s) { return q(xi + s, eta).x(); });
  const double d2 = difference([&](double s) { return q(xi, eta + s).y(); });
  return (d1 + d2) / tangents_at(chart, xi, eta).sqrt_g;
}

double curl(const Chart& chart, const FluxDensity& q, double xi, double eta) {
  const auto covariant = [&](double x, double y, int a) {
    const Tangents t = tangents_at(chart, x, y);
    return t.covariant.row(a).dot(q(x, y)) / t.sqrt_g;
  };
  const double d1 = difference([&](double s) { return covariant(xi + s, eta, 1); });
  const double d2 = difference([&](double s) { return covariant(xi, eta + s, 0); });
  return (d1 - d2) / tangents_at(chart, xi, eta).sqrt_g;
}

double still_at_walls(double xi, double eta) {
  const double s = std::sin(kPi * xi) * std::sin(kPi * eta);
  return s * s * s * s;
}

film::FilmGrid make_grid(int n) {
  return film::make_film_grid({0, 1, 0, 1}, n, n, std::vector<int>(static_cast<size_t>(n) * n, 0));
}

film::FilmMetric make_metric(const Chart& chart, const film::FilmGrid& grid) {
  Eigen::Matrix3Xd vertices(3, grid.n_vertices());
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      vertices.col(grid.vertex(i, j)) = chart.point(grid.vertex_xi(i), grid.vertex_eta(j));
    }
  }
  return film::compute_film_metric(grid, vertices);
}

Vector2d centre_of(const film::FilmGrid& grid, int cell) {
  const int slot = grid.slot_of_cell[cell];
  return {(grid.slot_i(slot) + 0.5) / grid.n_xi, (grid.slot_j(slot) + 0.5) / grid.n_eta};
}

Eigen::VectorXd sample_at_cells(const film::FilmGrid& grid, const Field& f) {
  Eigen::VectorXd values(grid.n_cells());
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    const Vector2d at = centre_of(grid, cell);
    values[cell] = f(at.x(), at.y());
  }
  return values;
}

Eigen::VectorXd sample_at_edges(const film::FilmGrid& grid, const Field& f) {
  Eigen::VectorXd values(grid.n_edges());
  for (int e = 0; e < grid.n_edges(); ++e) {
    const Vector2d at = 0.5 * (centre_of(grid, grid.edges[e].left) + centre_of(grid, grid.edges[e].right));
    values[e] = f(at.x(), at.y());
  }
  return values;
}

Eigen::VectorXd integrate_over_edges(const film::FilmGrid& grid, const FluxDensity& q) {
  constexpr std::array<double, 3> kPlaces = {-0.7745966692414834, 0.0, 0.7745966692414834};
  constexpr std::array<double, 3> kWeights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  Eigen::VectorXd flux = Eigen::VectorXd::Zero(grid.n_edges());
  for (int e = 0; e < grid.n_edges(); ++e) {
    const film::Edge& edge = grid.edges[e];
    const Vector2d middle = 0.5 * (centre_of(grid, edge.left) + centre_of(grid, edge.right));
    const bool along_xi = edge.direction == 0;
    const double length = 1.0 / (along_xi ? grid.n_eta : grid.n_xi);
    for (int k = 0; k < 3; ++k) {
      const double offset = 0.5 * length * kPlaces[k];
      const Vector2d at =
          along_xi ? Vector2d(middle.x(), middle.y() + offset) : Vector2d(middle.x() + offset, middle.y());
      flux[e] += length * kWeights[k] * q(at.x(), at.y())[edge.direction];
    }
  }
  return flux;
}

double cell_error(const film::FilmMetric& metric, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd weighted = (a - b).cwiseAbs2();
  return std::sqrt(metric.area.dot(weighted) / metric.area.dot(Eigen::VectorXd(b.cwiseAbs2())));
}

double edge_error(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).norm() / b.norm();
}

}  // namespace lipofill::verification
