#include "core/coupling/pressure_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/film/film_metric.h"

namespace lipofill::coupling {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int kSide = 14;
constexpr int kCells = kSide * kSide;
static_assert(kCells > PressureSolver::kMaxDirectCells);

/// A film of 2 mm cells, wet in its middle and dry elsewhere, on walls like tissue: each cell moves its neighbours.
struct LaggedCase {
  film::FilmGrid grid = film::make_film_grid({0, 1, 0, 1}, kSide, kSide, std::vector<int>(kCells, 0));
  film::FilmMetric metric;
  film::FilmProjection projection{grid};
  Eigen::MatrixXd c;
  WallCompliance walls;

  explicit LaggedCase(double compliance = 1e-12) {
    Eigen::Matrix3Xd vertices(3, grid.n_vertices());
    for (int j = 0; j <= kSide; ++j) {
      for (int i = 0; i <= kSide; ++i) vertices.col(grid.vertex(i, j)) << 2e-3 * i, 2e-3 * j, 0.0;
    }
    metric = film::compute_film_metric(grid, vertices);
    c.resize(kCells, kCells);
    for (int a = 0; a < kCells; ++a) {
      for (int b = 0; b < kCells; ++b) {
        const double distance = std::hypot(a % kSide - b % kSide, a / kSide - b / kSide);
        c(a, b) = compliance * std::exp(-0.5 * distance);
      }
    }
    walls.dense = &c;
  }

  /// dt J of a blister of this height.
  Eigen::VectorXd take_thickness(double height, double dt) {
    Eigen::VectorXd volume(kCells);
    for (int cell = 0; cell < kCells; ++cell) {
      const double r = std::hypot(cell % kSide - kSide / 2, cell / kSide - kSide / 2);
      volume[cell] = metric.area[cell] * height * std::max(0.0, 1.0 - 0.04 * r * r);
    }
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(grid.n_edges());
    film::FilmStepInput input;
    input.metric = &metric;
    input.fat = {};
    input.volume = volume;
    input.injected = Eigen::VectorXd::Zero(kCells);
    input.velocity = still;
    input.body_force = still;
    input.dt = dt;
    projection.begin_step(std::move(input));
    projection.set_thickness(volume, still);
    return projection.linearise(Eigen::VectorXd::Zero(kCells)).coeffs();
  }

  Eigen::VectorXd solve_densely(const std::vector<char>& held, const Eigen::VectorXd& r) {
    Eigen::MatrixXd system = c + Eigen::MatrixXd(projection.linearise(Eigen::VectorXd::Zero(kCells)));
    Eigen::VectorXd right = r;
    for (int i = 0; i < kCells; ++i) {
      if (!held[i]) continue;
      system.row(i).setZero();
      system.col(i).setZero();
      system(i, i) = 1.0;
      right[i] = 0.0;
    }
    return system.ldlt().solve(right);
  }
};

void expect_solved(LaggedCase& c, PressureSolver& solver, const std::vector<char>& held, double bound) {
  const Eigen::VectorXd r = 1e-9 * Eigen::VectorXd::Random(kCells);
  Eigen::VectorXd dp, moved;
  ASSERT_TRUE(solver.solve(Eigen::VectorXd::Zero(kCells), held, r, 1e-10 * r.cwiseAbs().maxCoeff(), dp, moved));
  const Eigen::VectorXd exact = c.solve_densely(held, r);
  EXPECT_LT((dp - exact).norm(), bound * exact.norm());
  EXPECT_LT((moved - c.c * dp).norm(), 1e-6 * (c.c * dp).norm());
}

TEST(PressureSolver, AnOldMobilityCostsIterationsNotTheAnswer) {
  for (const double height_now : {1.0e-3, 1.05e-3, 1.2e-3}) {
    LaggedCase c;
    PressureSolver solver({&c.projection});
    solver.set_walls(c.walls);
    ASSERT_TRUE(solver.is_lagged());
    solver.keep_mobility({c.take_thickness(1e-3, 0.01)});
    c.take_thickness(height_now, 0.01);
    expect_solved(c, solver, std::vector<char>(kCells, 0), 1e-4);
    EXPECT_EQ(solver.fallbacks(), 0);
    EXPECT_LE(solver.iterations(), height_now == 1e-3 ? 5 : 14);
  }
}

TEST(PressureSolver, HeldCellsKeepTheirPressure) {
  LaggedCase c;
  PressureSolver solver({&c.projection});
  solver.set_walls(c.walls);
  solver.keep_mobility({c.take_thickness(1e-3, 0.01)});
  std::vector<char> held(kCells, 0);
  for (int cell = 0; cell < kCells; cell += 5) held[cell] = 1;
  expect_solved(c, solver, held, 1e-4);
}

TEST(PressureSolver, ADryFilmAndAMobilityOfAnotherWorldFallBackToTheDirectSolve) {
  LaggedCase c;
  PressureSolver solver({&c.projection});
  solver.set_walls(c.walls);
  solver.keep_mobility({c.take_thickness(30e-3, 100.0)});
  c.take_thickness(0.0, 0.01);
  expect_solved(c, solver, std::vector<char>(kCells, 0), 1e-4);
  EXPECT_EQ(solver.fallbacks(), 1);
}

TEST(PressureSolver, ImplicitWallsGiveTheAnswerOfDenseOnes) {
  // A chain of springs under every cell, so that S is sparse and C = B S^-1 B^T is not diagonal.
  LaggedCase c;
  Eigen::MatrixXd s = Eigen::MatrixXd::Zero(kCells, kCells);
  for (int k = 0; k < kCells; ++k) {
    s(k, k) += 1e3;
    if (k + 1 == kCells) break;
    s(k, k) += 4e3;
    s(k + 1, k + 1) += 4e3;
    s(k, k + 1) -= 4e3;
    s(k + 1, k) -= 4e3;
  }
  const Eigen::MatrixXd b = 4e-6 * Eigen::MatrixXd::Identity(kCells, kCells);
  const Sparse s_lower = Sparse(s.sparseView()).triangularView<Eigen::Lower>();
  const Sparse b_sparse = b.sparseView();
  CoupledFactor factor(*FactorAnalysis::create(s_lower, Sparse(0, kCells)));
  ASSERT_TRUE(factor.factorise(s_lower, b_sparse, Precision::kDouble));
  c.c = b * s.llt().solve(b.transpose());
  std::vector<int> cells(kCells);
  for (int k = 0; k < kCells; ++k) cells[k] = k;
  WallCompliance implicit;
  implicit.tissue = &factor;
  implicit.tissue_cells = &cells;
  implicit.diagonal = factor.lumped_compliance();
  PressureSolver solver({&c.projection});
  solver.set_walls(implicit);
  c.take_thickness(1e-3, 0.01);
  expect_solved(c, solver, std::vector<char>(kCells, 0), 1e-6);
  EXPECT_GT(solver.iterations(), 0);
}

}  // namespace
}  // namespace lipofill::coupling
