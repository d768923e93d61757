// Implicit viscosity of the film on charts that are not orthogonal: the Hodge form
//
//     h (u' - u)/dt = nu [grad(h div u') - rot(h curl u')] - h (12 nu/h^2) u'
//
// solved for a u' that is given, with the u it needs.

#include <gtest/gtest.h>

#include <cmath>

#include "core/film/viscosity.h"
#include "tests/verification/film/manufactured_charts.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDt = 0.2;
const film::Fat kFat{0.06, 1.5, film::WallFriction::kNoSlip};
constexpr double kNu = 0.06 / 1.5;

/// Velocity and thickness that meet the walls as the operator assumes: u.n = 0, curl u = 0, d(h div
/// u)/dn = 0.
struct Motion {
  FluxDensity velocity;
  Field thickness;
};

double still(double y) {
  const double s = std::sin(kPi * y);
  return s * s * s * s;
}

/// Fields that vanish at the walls: any chart.
Motion make_still_motion() {
  return {[](double xi, double eta) -> Eigen::Vector2d {
            return still_at_walls(xi, eta) * Eigen::Vector2d(1.0 + xi, 0.4 - eta);
          },
          [](double xi, double eta) { return 1.0 + 0.4 * std::sin(2.0 * xi) * std::cos(3.0 * eta); }};
}

/// A gradient and a rotation that slip along the walls x = const, which are geodesics on all charts
/// with natural walls; latitudes of the sphere are not, and the motion is still there.
Motion make_slipping_motion(const Chart& chart) {
  const Field potential = chart.pull_back([](double x, double y) { return std::cos(kPi * x) * still(y); });
  const Field stream = chart.pull_back([](double x, double y) { return std::sin(kPi * x) * still(y); });
  return {[chart, potential, stream](double xi, double eta) -> Eigen::Vector2d {
            return 0.3 * gradient_flux(chart, potential, xi, eta) +
                   0.5 * Eigen::Vector2d(d_eta(stream, xi, eta), -d_xi(stream, xi, eta));
          },
          chart.pull_back([](double x, double y) { return 1.0 + 0.3 * std::cos(kPi * x) * std::cos(2.0 * kPi * y); })};
}

/// The u that one step takes to u'.
FluxDensity velocity_before(const Chart& chart, const Motion& motion) {
  const Field& h = motion.thickness;
  const FluxDensity& u = motion.velocity;
  const Field spread = [&chart, h, u](double xi, double eta) { return h(xi, eta) * divergence(chart, u, xi, eta); };
  const Field spin = [&chart, h, u](double xi, double eta) { return h(xi, eta) * curl(chart, u, xi, eta); };
  return [&chart, h, u, spread, spin](double xi, double eta) -> Eigen::Vector2d {
    const Eigen::Vector2d rotation(d_eta(spin, xi, eta), -d_xi(spin, xi, eta));
    const Eigen::Vector2d diffusion = gradient_flux(chart, spread, xi, eta) - rotation;
    const double thickness = h(xi, eta);
    const double friction = 12.0 * kNu / (thickness * thickness);
    return (1.0 + kDt * friction) * u(xi, eta) - kDt * kNu / thickness * diffusion;
  };
}

/// Error of u' in the L2 norm of edge fluxes.
double step_error(const Chart& chart, const Motion& motion, int n) {
  const film::FilmGrid grid = make_grid(n);
  const film::FilmMetric metric = make_metric(chart, grid);
  const FluxDensity before = velocity_before(chart, motion);
  Eigen::VectorXd start(grid.n_edges());
  for (int e = 0; e < grid.n_edges(); ++e) {
    const film::Edge& edge = grid.edges[e];
    const Eigen::Vector2d at = 0.5 * (centre_of(grid, edge.left) + centre_of(grid, edge.right));
    start[e] = before(at.x(), at.y())[edge.direction] / n;
  }
  const Eigen::VectorXd after = film::ImplicitViscosity(grid).advance(
      grid, metric, kFat, sample_at_cells(grid, motion.thickness), sample_at_edges(grid, motion.thickness), start, kDt);
  return edge_error(after, integrate_over_edges(grid, motion.velocity));
}

void record_orders(const std::string& how, const Chart& chart, const Motion& motion) {
  Case record({"film/12-chart-diffusion", "Viscosity on charts that are not orthogonal",
               "one implicit step to an analytic velocity from the velocity that the Hodge form asks for, thickness "
               "varying"});
  Series series{"u, " + how + ", " + chart.name, "cells a side", {}, {}};
  for (const int n : {10, 20, 40}) {
    series.resolutions.push_back(n);
    series.errors.push_back(step_error(chart, motion, n));
  }
  record.record_series(series);
}

class ChartDiffusion : public testing::TestWithParam<int> {};

TEST_P(ChartDiffusion, IsOfSecondOrder) {
  const Chart& chart = charts()[GetParam()];
  record_orders("still at walls", chart, make_still_motion());
  if (chart.natural_walls) record_orders("slipping along walls", chart, make_slipping_motion(chart));
}

INSTANTIATE_TEST_SUITE_P(Charts, ChartDiffusion, testing::Range(0, 6));

}  // namespace
}  // namespace lipofill::verification
