// Flow laws of fat between two walls, in one quadrant and over a film.

#include "core/film/rheology.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/film/edge_operators.h"
#include "core/film/film_metric.h"
#include "core/film/flow_law.h"

namespace lipofill::film {
namespace {

Fat herschel_bulkley(double consistency, double n, double yield_stress) {
  Fat fat;
  fat.viscosity = consistency;
  fat.flow_index = n;
  fat.yield_stress = yield_stress;
  return fat;
}

/// Flux per width by integrating the velocity profile across half the gap:
/// du/dz = ((tau - tau_y)/K)^(1/n), tau = G z.
double integrate_profile(const Fat& fat, double h, double gradient) {
  const int n = 200000;
  double flux = 0.0;
  for (int k = 0; k < n; ++k) {
    const double z = 0.5 * h * (k + 0.5) / n;
    const double excess = gradient * z - fat.yield_stress;
    // Integrating by parts, q = 2 * integral of z du/dz.
    if (excess > 0.0) flux += 2.0 * z * std::pow(excess / fat.viscosity, 1.0 / fat.flow_index) * 0.5 * h / n;
  }
  return flux;
}

TEST(FlowFactorTest, IsTheIntegralOfTheVelocityProfile) {
  for (const Fat& fat : {herschel_bulkley(10, 1, 0), herschel_bulkley(10, 0.5, 0), herschel_bulkley(10, 1, 2),
                         herschel_bulkley(48, 0.28, 7), herschel_bulkley(20, 0.6, 5)}) {
    for (const double gradient : {3e3, 1e4, 1e5, 1e6}) {
      const double h = 1e-3;
      const double newtonian = h * h * h * gradient / (12.0 * fat.viscosity);
      const double expected = integrate_profile(fat, h, gradient);
      EXPECT_NEAR(compute_flow_factor(fat, h, gradient).value * newtonian, expected, 1e-4 * expected + 1e-25)
          << fat.flow_index << " " << fat.yield_stress << " " << gradient;
    }
  }
}

TEST(FlowFactorTest, SlopeIsThatOfTheValue) {
  for (const Fat& fat : {herschel_bulkley(10, 0.5, 0), herschel_bulkley(10, 1, 2), herschel_bulkley(48, 0.28, 7)}) {
    const double h = 1.3e-3;
    const double gradient = 4e4;
    const double step = 1.0;
    const double difference =
        (compute_flow_factor(fat, h, gradient + step).value - compute_flow_factor(fat, h, gradient - step).value) /
        (2.0 * step);
    EXPECT_NEAR(compute_flow_factor(fat, h, gradient).slope, difference, 1e-6 * std::abs(difference));
  }
}

TEST(FlowFactorTest, NothingFlowsBelowTheYieldStress) {
  const Fat fat = herschel_bulkley(48, 0.28, 7);
  const double h = 1e-3;
  EXPECT_EQ(compute_flow_factor(fat, h, 2.0 * 7.0 / h).value, 0.0);
  EXPECT_EQ(compute_flow_factor(fat, h, 1.0).value, 0.0);
  EXPECT_GT(compute_flow_factor(fat, h, 2.0 * 7.0 / h * 1.01).value, 0.0);
}

struct SkewedFilm {
  FilmGrid grid = make_film_grid({0, 1, 0, 1}, 4, 3, std::vector<int>(12, 0));
  FilmMetric metric;
  SkewedFilm() {
    Eigen::Matrix3Xd vertices(3, grid.n_vertices());
    for (int j = 0; j <= grid.n_eta; ++j) {
      for (int i = 0; i <= grid.n_xi; ++i) vertices.col(grid.vertex(i, j)) << 2e-3 * i + 1e-3 * j, 1.5e-3 * j, 0.0;
    }
    metric = compute_film_metric(grid, vertices);
  }
};

Eigen::VectorXd flux_of(FlowLaw& law, const Eigen::VectorXd& drive) {
  Eigen::VectorXd flux = Eigen::VectorXd::Zero(drive.size());
  law.add_flux(drive, flux);
  return flux;
}

TEST(FlowLawTest, TangentIsTheDerivativeAndSemiDefinite) {
  const SkewedFilm film;
  const int n = film.grid.n_edges();
  const Eigen::VectorXd h = Eigen::VectorXd::LinSpaced(n, 0.6e-3, 1.4e-3);
  const Eigen::VectorXd drive = 40.0 * Eigen::VectorXd::LinSpaced(n, -1.0, 1.0).array().sin().matrix() +
                                Eigen::VectorXd::LinSpaced(n, 30.0, -50.0);
  Fat elastic = herschel_bulkley(48, 0.28, 3);
  elastic.shear_modulus = 70.0;
  for (const Fat& fat :
       {herschel_bulkley(10, 1, 0), herschel_bulkley(10, 0.5, 0), herschel_bulkley(10, 1, 2), elastic}) {
    FlowLaw law(film.grid);
    law.begin_step(film.metric, fat, 0.01);
    law.set_thickness(h, Eigen::VectorXd::Constant(n, 1e-3));
    const QuadrantForms tangent = law.linearise(drive);
    Eigen::MatrixXd dense(n, n);
    for (int e = 0; e < n; ++e) dense.col(e) = apply_forms(film.grid, tangent, Eigen::VectorXd::Unit(n, e));
    EXPECT_LT((dense - dense.transpose()).cwiseAbs().maxCoeff(), 1e-14 * dense.cwiseAbs().maxCoeff());
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues()[0], 0.0);
    for (int e = 0; e < n; ++e) {
      const double step = 1e-4;
      const Eigen::VectorXd difference = (flux_of(law, drive + step * Eigen::VectorXd::Unit(n, e)) -
                                          flux_of(law, drive - step * Eigen::VectorXd::Unit(n, e))) /
                                         (2.0 * step);
      EXPECT_LT((dense.col(e) - difference).norm(), 1e-5 * dense.norm()) << "edge " << e;
    }
  }
}

TEST(FlowLawTest, NewtonianFatWithAModulusRelaxesToViscousFlow) {
  // One slot in series: F = h^3/12 (D/mu + (D - s)/(G dt)); at s = D only the viscous part is left.
  const SkewedFilm film;
  const int n = film.grid.n_edges();
  const Eigen::VectorXd h = Eigen::VectorXd::Constant(n, 1e-3);
  const Eigen::VectorXd drive = Eigen::VectorXd::LinSpaced(n, -20.0, 35.0);
  Fat viscous;
  Fat elastic = viscous;
  elastic.shear_modulus = 70.0;
  FlowLaw law(film.grid);
  law.begin_step(film.metric, elastic, 0.01);
  law.set_thickness(h, 0.5 * h.cwiseProduct(drive));
  const Eigen::VectorXd relaxed = flux_of(law, drive);
  law.begin_step(film.metric, viscous, 1e9);  // so long a step has no inertia
  law.set_thickness(h, {});
  EXPECT_LT((relaxed - flux_of(law, drive)).norm(), 1e-9 * relaxed.norm());
}

}  // namespace
}  // namespace lipofill::film
