// Viscosity, advection and mobility of the film on their own.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "core/film/advection.h"
#include "core/film/edge_operators.h"
#include "core/film/rheology.h"
#include "core/film/viscosity.h"

namespace lipofill::film {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Box {
  FilmGrid grid;
  FilmMetric metric;
  Box(int n, double side) : grid(make_film_grid({0, 1, 0, 1}, n, n, std::vector<int>(n * n, 0))) {
    Eigen::Matrix3Xd vertices(3, grid.n_vertices());
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) vertices.col(grid.vertex(i, j)) << side * i / n, side * j / n, 0.0;
    }
    metric = compute_film_metric(grid, vertices);
  }
  /// Edge velocities of the stream function sin x sin y: exact fluxes, walls are streamlines.
  Eigen::VectorXd vortex() const {
    Eigen::VectorXd u(grid.n_edges());
    const auto psi = [&](int v) { return std::sin(metric.vertices(0, v)) * std::sin(metric.vertices(1, v)); };
    for (int e = 0; e < grid.n_edges(); ++e) {
      const int slot = grid.slot_of_cell[grid.edges[e].right];
      const int i = grid.slot_i(slot);
      const int j = grid.slot_j(slot);
      u[e] = grid.edges[e].direction == 0 ? psi(grid.vertex(i, j + 1)) - psi(grid.vertex(i, j))
                                          : psi(grid.vertex(i, j)) - psi(grid.vertex(i + 1, j));
    }
    return u;
  }
};

/// Taylor-Green decay after time 1 with nu = 0.01, relative to the start.
double decay(int n, int steps, double friction_thickness) {
  const Box box(n, kPi);
  Fat fat{0.01, 1.0, friction_thickness > 0.0 ? WallFriction::kNoSlip : WallFriction::kNone};
  const double h = friction_thickness > 0.0 ? friction_thickness : 1.0;
  ImplicitViscosity viscosity(box.grid);
  Eigen::VectorXd u = box.vortex();
  const double before = u.norm();
  const Eigen::VectorXd cells = Eigen::VectorXd::Constant(box.grid.n_cells(), h);
  const Eigen::VectorXd edges = Eigen::VectorXd::Constant(box.grid.n_edges(), h);
  for (int k = 0; k < steps; ++k) u = viscosity.advance(box.grid, box.metric, fat, cells, edges, u, 1.0 / steps);
  return u.norm() / before;
}

// verification.md case 4: velocity 0.980199 of the start; with wall drag 12 nu/h^2, h = 1:
// 0.869358.
TEST(TaylorGreen, DecaysAtTheViscousRate) {
  EXPECT_NEAR(decay(32, 40, 0.0), 0.980199, 5e-5);
  EXPECT_NEAR(decay(16, 400, 1.0), 0.869358, 3e-4);
}

TEST(TaylorGreen, IsFirstOrderInTime) {
  const double coarse = decay(16, 10, 1.0) - 0.869358;
  const double fine = decay(16, 20, 1.0) - 0.869358;
  EXPECT_NEAR(std::log2(coarse / fine), 1.0, 0.1);
}

TEST(Viscosity, NeverAddsEnergyHoweverLargeTheStep) {
  const Box box(12, kPi);
  ImplicitViscosity viscosity(box.grid);
  const Eigen::VectorXd u = Eigen::VectorXd::Random(box.grid.n_edges());
  const Eigen::VectorXd cells = Eigen::VectorXd::Constant(box.grid.n_cells(), 1e-3);
  const Eigen::VectorXd edges = Eigen::VectorXd::Constant(box.grid.n_edges(), 1e-3);
  for (const double dt : {1e-3, 1.0, 1e3}) {
    EXPECT_LE(viscosity.advance(box.grid, box.metric, {15.0, 920.0, WallFriction::kNoSlip}, cells, edges, u, dt).norm(),
              u.norm());
  }
}

/// M(w) of the docstring of compute_unit_mass_forms, quadrant by quadrant.
Eigen::MatrixXd make_mass(const Box& box, const Eigen::VectorXd& w) {
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(w.size(), w.size());
  for (int cell = 0; cell < box.grid.n_cells(); ++cell) {
    for (int q = 0; q < 4; ++q) {
      const QuadrantMetric& g = box.metric.quadrants[cell][q];
      const auto [a, b] = quadrant_edges(box.grid, cell, q);
      if (a >= 0) mass(a, a) += 0.25 / g.sqrt_g * w[a] * g.g11;
      if (b >= 0) mass(b, b) += 0.25 / g.sqrt_g * w[b] * g.g22;
      if (a < 0 || b < 0) continue;
      mass(a, b) += 0.25 / g.sqrt_g * std::sqrt(w[a] * w[b]) * g.g12;
      mass(b, a) += 0.25 / g.sqrt_g * std::sqrt(w[a] * w[b]) * g.g12;
    }
  }
  return mass;
}

/// D^T (h/a) D + M(1) K^T (h/a_v) K M(1) for one thickness h, out of the closed forms of one square
/// cell: its sides sum to the outflow, those around a vertex to the circulation.
Eigen::MatrixXd make_diffusion(const Box& box, double h) {
  const int n = box.grid.n_xi;
  const double area = box.metric.area[0];
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(box.grid.n_edges(), box.grid.n_edges());
  Eigen::MatrixXd outflow = Eigen::MatrixXd::Zero(n * n, box.grid.n_edges());
  Eigen::MatrixXd circulation = Eigen::MatrixXd::Zero((n - 1) * (n - 1), box.grid.n_edges());
  for (int e = 0; e < box.grid.n_edges(); ++e) outflow.col(e) = compute_outflow(box.grid, identity.col(e));
  for (int j = 0; j + 1 < n; ++j) {
    for (int i = 0; i + 1 < n; ++i) {
      const auto side = [&](int k, int l, Side s) { return box.grid.edge_of_side[l * n + k][s]; };
      auto around = circulation.row(j * (n - 1) + i);
      around[side(i, j, kHighXi)] = around[side(i + 1, j, kHighEta)] = 1.0;
      around[side(i, j + 1, kHighXi)] = around[side(i, j, kHighEta)] = -1.0;
    }
  }
  const Eigen::MatrixXd curl = circulation * make_mass(box, Eigen::VectorXd::Ones(box.grid.n_edges()));
  return h / area * (outflow.transpose() * outflow + curl.transpose() * curl);
}

/// The system of the docstring solved by a dense factorisation, with and without friction, short
/// and long steps.
TEST(Viscosity, SolvesTheSystemOfItsDocstring) {
  const Box box(7, 0.02);
  const double h = 1e-3;
  ImplicitViscosity viscosity(box.grid);
  const Eigen::VectorXd cells = Eigen::VectorXd::Constant(box.grid.n_cells(), h);
  Eigen::VectorXd edges = Eigen::VectorXd::LinSpaced(box.grid.n_edges(), 0.8 * h, 1.2 * h);
  edges[17] = 0.0;
  const Eigen::VectorXd filled = edges.cwiseMax(1e-7);
  const Eigen::VectorXd u = Eigen::VectorXd::Random(box.grid.n_edges());
  for (const WallFriction wall_friction : {WallFriction::kNoSlip, WallFriction::kNone}) {
    for (const double dt : {1e-3, 10.0}) {
      const Fat fat{15.0, 920.0, wall_friction};
      Eigen::VectorXd damped = filled;
      for (double& thickness : damped) thickness *= 1.0 + dt * compute_friction_rate(fat, thickness);
      const Eigen::MatrixXd system = make_mass(box, damped) + dt * fat.viscosity / fat.density * make_diffusion(box, h);
      Eigen::VectorXd expected = system.ldlt().solve(make_mass(box, filled) * u);
      expected[17] = 0.0;
      const Eigen::VectorXd next = viscosity.advance(box.grid, box.metric, fat, cells, edges, u, dt);
      EXPECT_LT((next - expected).norm(), 1e-10 * expected.norm()) << static_cast<int>(wall_friction) << " " << dt;
    }
  }
}

TEST(Advection, LeavesAUniformFlowAloneAwayFromWalls) {
  const Box box(10, 1.0);
  Eigen::VectorXd u(box.grid.n_edges());
  for (int e = 0; e < box.grid.n_edges(); ++e) u[e] = 0.1 * (box.grid.edges[e].direction == 0 ? 0.3 : 0.0);
  const Eigen::VectorXd next = advect_velocity(box.grid, box.metric, u, 0.2);
  for (int e = 0; e < box.grid.n_edges(); ++e) {
    if (box.grid.edges[e].direction != 0) continue;
    const int i = box.grid.slot_i(box.grid.slot_of_cell[box.grid.edges[e].right]);
    if (i < 3) continue;
    EXPECT_NEAR(next[e], u[e], 1e-15);
  }
}

/// What comes from beyond all numbers comes from nowhere: the velocity stays as it is.
TEST(Advection, AVelocityBeyondAllMeasureIsNotCarried) {
  const Box box(10, 1.0);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(box.grid.n_edges());
  for (int e = 0; e < box.grid.n_edges(); ++e) u[e] = box.grid.edges[e].direction == 0 ? 1e300 : 0.0;
  const Eigen::VectorXd next = advect_velocity(box.grid, box.metric, u, 1e10);
  for (int e = 0; e < box.grid.n_edges(); ++e) EXPECT_NEAR(next[e] * 1e-300, u[e] * 1e-300, 1e-12);
}

TEST(Advection, CarriesAPatternDownstream) {
  // A shear layer v(x) carried by a uniform u: v'(x) = v(x - u dt), to second order of
  // interpolation.
  const auto error = [](int n) {
    const Box box(n, 1.0);
    const double width = 1.0 / n;
    const double speed = 0.4;
    const double dt = 1.0 / 6.0;  // a third of a cell between samples at both resolutions
    const auto v = [](double x) { return std::exp(-80.0 * (x - 0.4) * (x - 0.4)); };
    Eigen::VectorXd u(box.grid.n_edges());
    const auto x_of = [&](int e) {
      return width * (box.grid.slot_i(box.grid.slot_of_cell[box.grid.edges[e].right]) + 0.5);
    };
    for (int e = 0; e < box.grid.n_edges(); ++e)
      u[e] = width * (box.grid.edges[e].direction == 0 ? speed : 1e-6 * v(x_of(e)));
    const Eigen::VectorXd next = advect_velocity(box.grid, box.metric, u, dt);
    double worst = 0.0;
    for (int e = 0; e < box.grid.n_edges(); ++e) {
      if (box.grid.edges[e].direction == 0 || x_of(e) < 0.3) continue;
      worst = std::max(worst, std::abs(next[e] / (1e-6 * width) - v(x_of(e) - speed * dt)));
    }
    return worst;
  };
  const double coarse = error(40);
  const double fine = error(80);
  EXPECT_LT(fine, 0.01);
  EXPECT_GT(std::log2(coarse / fine), 1.5) << coarse << " " << fine;
}

TEST(Rheology, ConductanceGoesFromInertiaToLubrication) {
  const Fat thick{1000.0, 920.0, WallFriction::kNoSlip};
  EXPECT_NEAR(compute_conductance(thick, 1e-3, 0.01), 1e-9 / (12.0 * 1000.0), 1e-9 / 12000.0 * 1e-5);
  const Fat thin{1e-9, 920.0, WallFriction::kNoSlip};
  EXPECT_NEAR(compute_conductance(thin, 1e-3, 0.01), 1e-3 * 0.01 / 920.0, 1e-3 * 0.01 / 920.0 * 1e-5);
  const Fat paper{15.0, 920.0, WallFriction::kNone};
  EXPECT_DOUBLE_EQ(compute_conductance(paper, 1e-3, 0.01), 1e-3 * 0.01 / 920.0);
  EXPECT_EQ(compute_conductance(thick, 0.0, 0.01), 0.0);
}

}  // namespace
}  // namespace lipofill::film
