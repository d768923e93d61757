// The pressure of the film on charts that are not orthogonal, with a thickness that varies: J p = s
// alone, and the whole projection with a velocity, gravity and sources.

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>

#include "core/film/film_projection.h"
#include "tests/verification/film/manufactured_charts.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kViscosity = 0.5;
const std::vector<int> kCells = {16, 32, 64};

/// A pressure without flow through the walls; it varies along them where the chart has natural
/// walls.
Field make_pressure(const Chart& chart) {
  if (!chart.natural_walls) return [](double xi, double eta) { return still_at_walls(xi, eta) * (1.0 + xi - eta); };
  return chart.pull_back([](double x, double y) { return std::cos(kPi * x) * std::cos(2.0 * kPi * y); });
}

/// From 0.5 to 1.5: the conductance varies 27-fold.
double thickness(double xi, double eta) {
  return 1.0 + 0.5 * std::sin(2.0 * xi + 0.5) * std::cos(2.5 * eta);
}

double conductance(double xi, double eta) {
  return std::pow(thickness(xi, eta), 3) / (12.0 * kViscosity);
}

/// Solves J p = s for the p without mean; J has only constants in its null space.
Eigen::VectorXd solve_without_mean(const Eigen::SparseMatrix<double>& j, const Eigen::VectorXd& s,
                                   const Eigen::VectorXd& area) {
  Eigen::SparseMatrix<double> pinned = j;
  pinned.coeffRef(0, 0) *= 2.0;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(pinned);
  const Eigen::VectorXd p = factor.solve(s);
  return p.array() - area.dot(p) / area.sum();
}

Eigen::VectorXd without_mean(const Eigen::VectorXd& p, const Eigen::VectorXd& area) {
  return p.array() - area.dot(p) / area.sum();
}

struct Errors {
  double pressure = 0.0;
  double flux = 0.0;
};

/// One series of pressures and one of fluxes for a chart.
template <typename Solve>
void record_orders(Case& record, const std::string& what, const Solve& solve) {
  Series pressure{"p, " + what, "cells a side", {}, {}};
  Series flux{"flux, " + what, "cells a side", {}, {}};
  for (const int n : kCells) {
    const Errors errors = solve(n);
    pressure.resolutions.push_back(n);
    pressure.errors.push_back(errors.pressure);
    flux.resolutions.push_back(n);
    flux.errors.push_back(errors.flux);
  }
  record.record_series(pressure);
  record.record_series(flux);
}

// J p = s with exact sources s: p in the L2 norm over the surface, its flux in that over the chart.
TEST(ChartProjection, PressureOfVaryingThicknessIsOfSecondOrder) {
  Case record({"film/13-chart-projection", "Projection on charts that are not orthogonal",
               "div(h^3/(12 mu) grad p) = -s with s from fluxes of an analytic p and h integrated over edges"});
  for (const Chart& chart : charts()) {
    const Field p = make_pressure(chart);
    record_orders(record, chart.name, [&](int n) {
      const film::FilmGrid grid = make_grid(n);
      const film::FilmMetric metric = make_metric(chart, grid);
      const Eigen::VectorXd exact_flux = integrate_over_edges(grid, [&](double xi, double eta) -> Eigen::Vector2d {
        return -conductance(xi, eta) * gradient_flux(chart, p, xi, eta);
      });
      const Eigen::VectorXd k = sample_at_edges(grid, conductance);
      film::PressureOperator op(grid);
      const Eigen::VectorXd solved =
          solve_without_mean(op.assemble(grid, metric, k), film::compute_outflow(grid, exact_flux), metric.area);
      const Eigen::VectorXd exact = without_mean(sample_at_cells(grid, p), metric.area);
      const Eigen::VectorXd flux =
          -film::apply_conductance(grid, metric, k, film::compute_edge_difference(grid, solved));
      return Errors{cell_error(metric, solved, exact), edge_error(flux, exact_flux)};
    });
  }
}

/// A swirling velocity before the projection, along the walls at the walls.
Eigen::Vector2d swirl(double xi, double eta) {
  return {std::sin(kPi * xi) * (1.0 + xi), std::sin(kPi * eta) * (0.5 - eta * xi)};
}

/// What drives the fat apart from pressure, as the potential whose gradient it is [Pa]; like a
/// pressure it pushes nothing through the walls.
Field make_weight(const Chart& chart) {
  if (!chart.natural_walls) return [](double xi, double eta) { return 0.5 * still_at_walls(xi, eta) * eta; };
  return chart.pull_back([](double x, double y) { return 0.3 * std::cos(2.0 * kPi * x) + 0.2 * std::cos(kPi * y); });
}

// F = h u - h^3/(12 mu) (grad p - rho b), V' = V + dt (s - div F) with sources s that keep V as it
// is. The edge thickness is upwind: p and F converge to second order in the L2 norm all the same.
TEST(ChartProjection, WholeStepIsOfSecondOrder) {
  Case record({"film/13-chart-projection", "Projection on charts that are not orthogonal",
               "div(h u - h^3/(12 mu) (grad p - rho b)) = s, all of them analytic, integrated over edges"});
  const double dt = 0.1;
  for (const Chart& chart : charts()) {
    const Field p = make_pressure(chart);
    const Field weight = make_weight(chart);
    const FluxDensity flux_density = [&](double xi, double eta) -> Eigen::Vector2d {
      return thickness(xi, eta) * swirl(xi, eta) -
             conductance(xi, eta) * (gradient_flux(chart, p, xi, eta) - gradient_flux(chart, weight, xi, eta));
    };
    record_orders(record, "whole step, " + chart.name, [&](int n) {
      const film::FilmGrid grid = make_grid(n);
      const film::FilmMetric metric = make_metric(chart, grid);
      const Eigen::VectorXd exact_flux = integrate_over_edges(grid, flux_density);
      film::FilmStepInput input;
      input.metric = &metric;
      input.fat.viscosity = kViscosity;
      input.fat.density = 1e-9;  // no inertia: k = h^3 / (12 mu)
      input.volume = sample_at_cells(grid, thickness).cwiseProduct(metric.area);
      input.injected = dt * film::compute_outflow(grid, exact_flux);
      input.velocity = integrate_over_edges(grid, swirl);
      input.body_force = film::compute_edge_difference(grid, sample_at_cells(grid, weight));
      input.dt = dt;
      const Eigen::VectorXd before = input.volume;
      film::FilmProjection projection(grid);
      projection.begin_step(input);
      projection.set_thickness(before, exact_flux);
      const Eigen::VectorXd none = Eigen::VectorXd::Zero(grid.n_cells());
      const Eigen::VectorXd excess = projection.compute_volume(projection.compute_flux(none)) - before;
      const Eigen::VectorXd solved = solve_without_mean(projection.linearise(none), excess, metric.area);
      const Eigen::VectorXd flux = projection.compute_flux(solved);
      EXPECT_LT((projection.compute_volume(flux) - before).cwiseAbs().maxCoeff(), 1e-10 * before.maxCoeff());
      const Eigen::VectorXd exact = without_mean(sample_at_cells(grid, p), metric.area);
      return Errors{cell_error(metric, solved, exact), edge_error(flux, exact_flux)};
    });
  }
}

}  // namespace
}  // namespace lipofill::verification
