// Semi-Lagrangian advection of the film's velocity on charts that are not orthogonal.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "core/film/advection.h"
#include "tests/verification/film/manufactured_charts.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

const std::vector<int> kCells = {16, 32, 64};

Case make_case() {
  return Case(
      {"film/15-chart-advection", "Advection on charts that are not orthogonal",
       "u(x, t) = u0(x - t u) on planes, solved by fixed-point iteration; on curved charts, a step of no length "
       "changes nothing"});
}

/// A smooth flow inside the walls.
Eigen::Vector2d inner_flow(double xi, double eta) {
  return still_at_walls(xi, eta) * Eigen::Vector2d(1.0 + eta, 0.6 - xi);
}

/// sqrt(g) u^a of a vector of space.
Eigen::Vector2d density_of(const Chart& chart, const Eigen::Vector3d& u, double xi, double eta) {
  const Tangents t = tangents_at(chart, xi, eta);
  const Eigen::Vector2d covariant(u.dot(t.g1), u.dot(t.g2));
  return t.sqrt_g * (t.covariant.inverse() * covariant);
}

Eigen::Vector3d vector_of(const Chart& chart, const Eigen::Vector2d& q, double xi, double eta) {
  const Tangents t = tangents_at(chart, xi, eta);
  return (q.x() * t.g1 + q.y() * t.g2) / t.sqrt_g;
}

/// The flow on a plane after dt: every particle keeps its velocity, so u(x) = u0(y) with y + dt
/// u0(y) = x. y is found in chart coordinates by a fixed-point iteration with the tangents at x.
Eigen::Vector2d flow_after(const Chart& chart, double dt, double xi, double eta) {
  const Tangents t = tangents_at(chart, xi, eta);
  const Eigen::Vector3d x = chart.point(xi, eta);
  Eigen::Vector2d foot(xi, eta);
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  for (int k = 0; k < 60; ++k) {
    u = vector_of(chart, inner_flow(foot.x(), foot.y()), foot.x(), foot.y());
    const Eigen::Vector3d miss = x - dt * u - chart.point(foot.x(), foot.y());
    foot += t.covariant.inverse() * Eigen::Vector2d(miss.dot(t.g1), miss.dot(t.g2));
  }
  return density_of(chart, u, xi, eta);
}

// One step of half a cell's passage: the error of a step is of second order in the L2 norm of edge
// fluxes, which makes the whole first order in time.
TEST(ChartAdvection, StepIsOfSecondOrderOnPlanes) {
  Case record = make_case();
  for (const Chart& chart : {charts()[0], charts()[1], charts()[2]}) {
    Series series{"u, " + chart.name, "cells a side", {}, {}};
    for (const int n : kCells) {
      const double dt = 0.5 / n;
      const film::FilmGrid grid = make_grid(n);
      const film::FilmMetric metric = make_metric(chart, grid);
      const Eigen::VectorXd start = integrate_over_edges(grid, inner_flow);
      const Eigen::VectorXd exact =
          integrate_over_edges(grid, [&](double xi, double eta) { return flow_after(chart, dt, xi, eta); });
      series.resolutions.push_back(n);
      series.errors.push_back(edge_error(film::advect_velocity(grid, metric, start, dt), exact));
      EXPECT_GT(edge_error(start, exact), 3.0 * series.errors.back());
    }
    record.record_series(series);
  }
}

// However the surface bends and the chart stretches, fat that does not move keeps its velocity:
// many short steps must not wear it away.
TEST(ChartAdvection, StepOfNoLengthChangesNothing) {
  Case record = make_case();
  for (const Chart& chart : charts()) {
    const film::FilmGrid grid = make_grid(12);
    const film::FilmMetric metric = make_metric(chart, grid);
    const Eigen::VectorXd start = integrate_over_edges(grid, inner_flow);
    const Eigen::VectorXd after = film::advect_velocity(grid, metric, start, 1e-12);
    record.record(
        {"change of u in 1e-12 s, relative, " + chart.name, "1", 1e-10, edge_error(after, start), 0.0, Bound::kAtMost});
  }
}

}  // namespace
}  // namespace lipofill::verification
