// Gradient and divergence of the film on charts that are not orthogonal, and the algebra they must
// obey there.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "core/film/edge_operators.h"
#include "tests/verification/film/manufactured_charts.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

constexpr double kPi = 3.14159265358979323846;
const std::vector<int> kCells = {16, 32, 64};

/// A pressure that drives no flow through the walls; along them it varies where the chart allows
/// it.
Field make_pressure(const Chart& chart) {
  if (!chart.natural_walls) return [](double xi, double eta) { return still_at_walls(xi, eta) * (1.0 + xi - eta); };
  return chart.pull_back([](double x, double y) { return std::cos(kPi * x) * std::cos(2.0 * kPi * y); });
}

/// Relative errors at the resolutions of kCells.
template <typename Error>
Series refine(const std::string& quantity, const Error& error) {
  Series series{quantity, "cells a side", {}, {}};
  for (const int n : kCells) {
    series.resolutions.push_back(n);
    series.errors.push_back(error(n));
  }
  return series;
}

Case make_gradient_case() {
  return Case({"film/10-chart-gradient", "Gradient on charts that are not orthogonal",
               "sqrt(g) g^ab d_b p of analytic pressures and charts, integrated over edges"});
}

// The flux of grad p through the edges of the film's grid: L2 norm over the chart, walls included.
TEST(ChartGradient, FluxThroughEdgesIsOfSecondOrder) {
  Case record = make_gradient_case();
  for (const Chart& chart : charts()) {
    const Field p = make_pressure(chart);
    record.record_series(refine("flux of grad p, " + chart.name, [&](int n) {
      const film::FilmGrid grid = make_grid(n);
      const film::FilmMetric metric = make_metric(chart, grid);
      const Eigen::VectorXd flux =
          film::apply_conductance(grid, metric, Eigen::VectorXd::Ones(grid.n_edges()),
                                  film::compute_edge_difference(grid, sample_at_cells(grid, p)));
      const Eigen::VectorXd exact =
          integrate_over_edges(grid, [&](double xi, double eta) { return gradient_flux(chart, p, xi, eta); });
      return edge_error(flux, exact);
    }));
  }
}

// The vector grad p at cell centres, L2 norm over the surface.
TEST(ChartGradient, VectorAtCellsIsOfSecondOrder) {
  Case record = make_gradient_case();
  for (const Chart& chart : charts()) {
    const Field p = make_pressure(chart);
    record.record_series(refine("grad p, " + chart.name, [&](int n) {
      const film::FilmGrid grid = make_grid(n);
      const film::FilmMetric metric = make_metric(chart, grid);
      const Eigen::VectorXd flux =
          film::apply_conductance(grid, metric, Eigen::VectorXd::Ones(grid.n_edges()),
                                  film::compute_edge_difference(grid, sample_at_cells(grid, p)));
      const Eigen::Matrix3Xd measured = film::compute_cell_velocity(grid, metric, flux);
      double sum = 0.0;
      double norm = 0.0;
      for (int cell = 0; cell < grid.n_cells(); ++cell) {
        const Eigen::Vector2d at = centre_of(grid, cell);
        const Eigen::Vector3d exact = gradient(chart, p, at.x(), at.y());
        sum += metric.area[cell] * (measured.col(cell) - exact).squaredNorm();
        norm += metric.area[cell] * exact.squaredNorm();
      }
      return std::sqrt(sum / norm);
    }));
  }
}

/// A velocity that no potential and no stream function alone gives; it leaves the walls alone.
Eigen::Vector2d swirl(double xi, double eta) {
  const double normal_xi = std::sin(kPi * xi);
  const double normal_eta = std::sin(kPi * eta);
  return {normal_xi * (1.0 + std::cos(2.0 * eta) + xi), normal_eta * (std::exp(xi) - 2.0 * eta)};
}

// Outflow of exact fluxes over the discrete area, against div u at cell centres: L2 norm over the
// surface.
TEST(ChartDivergence, OfExactFluxesIsOfSecondOrder) {
  Case record({"film/11-chart-divergence", "Divergence on charts that are not orthogonal",
               "1/sqrt(g) d_a (sqrt(g) u^a) of an analytic velocity"});
  for (const Chart& chart : charts()) {
    record.record_series(refine("div u, " + chart.name, [&](int n) {
      const film::FilmGrid grid = make_grid(n);
      const film::FilmMetric metric = make_metric(chart, grid);
      const Eigen::VectorXd outflow = film::compute_outflow(grid, integrate_over_edges(grid, swirl));
      EXPECT_NEAR(outflow.sum(), 0.0, 1e-13);
      const Eigen::VectorXd exact =
          sample_at_cells(grid, [&](double xi, double eta) { return divergence(chart, swirl, xi, eta); });
      return cell_error(metric, outflow.cwiseQuotient(metric.area), exact);
    }));
  }
}

/// Two zones side by side, one of them with a hole, and an island of one cell: three components.
film::FilmGrid make_grid_of_zones() {
  const int n = 12;
  std::vector<int> zones(n * n, -1);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      if (j < 10) zones[j * n + i] = i < 7 ? 0 : 1;
    }
  }
  zones[4 * n + 3] = -1;
  zones[11 * n + 11] = 2;
  return film::make_film_grid({0, 1, 0, 1}, n, n, zones);
}

Eigen::VectorXd random_vector(Eigen::Index size, double low, double high, std::mt19937& random) {
  std::uniform_real_distribution<double> distribution(low, high);
  Eigen::VectorXd values(size);
  for (double& value : values) value = distribution(random);
  return values;
}

/// Worst departures over all charts.
struct Algebra {
  double asymmetry = 0.0;           ///< |J - J^T| / |J|
  double least_eigenvalue = 0.0;    ///< over the largest
  double null_space = 0.0;          ///< |J 1_z| / |J|, 1_z one in a component
  double first_eigenvalue = 1e300;  ///< the least that is not of a constant, over the largest
  double adjointness = 0.0;         ///< |<F, G p> + <D F, p>| / (|F| |G p|)
  double factorisation = 0.0;       ///< |J p - D W (-G p)| / |J p|
};

void examine(const Chart& chart, std::mt19937& random, Algebra& worst) {
  const film::FilmGrid grid = make_grid_of_zones();
  const film::FilmMetric metric = make_metric(chart, grid);
  // Four decades: a thin film beside a thick one.
  const Eigen::VectorXd k =
      random_vector(grid.n_edges(), -4.0, 0.0, random).unaryExpr([](double e) { return std::pow(10.0, e); });
  film::PressureOperator op(grid);
  const Eigen::MatrixXd j = op.assemble(grid, metric, k);
  const Eigen::VectorXd p = random_vector(grid.n_cells(), -1.0, 1.0, random);
  const Eigen::VectorXd flux = random_vector(grid.n_edges(), -1.0, 1.0, random);
  const Eigen::VectorXd difference = film::compute_edge_difference(grid, p);
  const double scale = j.cwiseAbs().maxCoeff();
  const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(j).eigenvalues();
  const double largest = eigenvalues[eigenvalues.size() - 1];
  worst.asymmetry = std::max(worst.asymmetry, (j - j.transpose()).cwiseAbs().maxCoeff() / scale);
  worst.least_eigenvalue = std::min(worst.least_eigenvalue, eigenvalues[0] / largest);
  worst.first_eigenvalue = std::min(worst.first_eigenvalue, eigenvalues[3] / largest);
  for (int zone = 0; zone < 3; ++zone) {
    Eigen::VectorXd one(grid.n_cells());
    for (int cell = 0; cell < grid.n_cells(); ++cell) one[cell] = grid.zone_of_cell[cell] == zone ? 1.0 : 0.0;
    worst.null_space = std::max(worst.null_space, (j * one).cwiseAbs().maxCoeff() / scale);
  }
  const double mismatch = flux.dot(difference) + film::compute_outflow(grid, flux).dot(p);
  worst.adjointness = std::max(worst.adjointness, std::abs(mismatch) / (flux.norm() * difference.norm()));
  const Eigen::VectorXd outflow = film::compute_outflow(grid, -film::apply_conductance(grid, metric, k, difference));
  worst.factorisation = std::max(worst.factorisation, (j * p - outflow).norm() / outflow.norm());
}

TEST(ChartAlgebra, HoldsToRoundOffOnEveryChart) {
  std::mt19937 random(7);
  Algebra worst;
  for (const Chart& chart : charts()) examine(chart, random, worst);
  Case record(
      {"film/14-chart-algebra", "Algebra of the film's operators on charts that are not orthogonal",
       "J = G^T W G with D = -G^T and W symmetric positive semi-definite; conductances over four decades, three "
       "components; the worst of six charts"});
  record.record({"asymmetry of J, relative", "1", 0.0, worst.asymmetry, 0.0, Bound::kAbsolute});
  record.record({"least eigenvalue of J over the largest", "1", -1e-14, worst.least_eigenvalue, 0.0, Bound::kAtLeast});
  record.record({"fourth eigenvalue over the largest: constants of three components are all of the null space", "1",
                 1e-6, worst.first_eigenvalue, 0.0, Bound::kAtLeast});
  record.record({"J of a component's constant, relative", "1", 1e-14, worst.null_space, 0.0, Bound::kAtMost});
  record.record({"<F, G p> + <D F, p>, relative", "1", 1e-14, worst.adjointness, 0.0, Bound::kAtMost});
  record.record({"J p against the outflow of -W G p, relative", "1", 1e-14, worst.factorisation, 0.0, Bound::kAtMost});
}

}  // namespace
}  // namespace lipofill::verification
