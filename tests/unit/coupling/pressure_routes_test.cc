// Each route to the pressures against a dense solve.

#include <memory>

#include "core/coupling/dense_pressure_route.h"
#include "core/coupling/diagonal_pressure_route.h"
#include "core/coupling/implicit_pressure_route.h"
#include "core/coupling/lagged_pressure_route.h"
#include "tests/unit/coupling/pressure_case.h"

namespace lipofill::coupling {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int kFew = 7;
constexpr int kMany = 14;

/// Of the film as its thickness was last taken.
void expect_solved(PressureCase& pressure_case, PressureRoute& route, const std::vector<char>& held, double bound) {
  PressureSystem system({&pressure_case.projection});
  system.set_compliance(pressure_case.c.diagonal());
  system.linearise(Eigen::VectorXd::Zero(pressure_case.n), held);
  Eigen::VectorXd r = 1e-9 * Eigen::VectorXd::Random(pressure_case.n);
  system.hold(r);
  Eigen::VectorXd dp, moved;
  ASSERT_TRUE(route.solve(system, r, 1e-10 * r.cwiseAbs().maxCoeff(), dp, moved));
  pressure_case.expect_solution(held, r, dp, moved, bound);
}

/// Springs apart under every cell: C is diagonal.
struct SpringCase : PressureCase {
  SpringCase() : PressureCase(kFew) {
    walls.dense = nullptr;
    walls.diagonal = metric.area / 1e6;
    c = walls.diagonal.asDiagonal();
  }
};

/// A chain of springs under every cell, so that S is sparse and C = B S^-1 B^T is not diagonal.
struct ChainCase : PressureCase {
  std::vector<int> cells;
  std::unique_ptr<CoupledFactor> factor;

  ChainCase() : PressureCase(kMany) {
    Eigen::MatrixXd s = Eigen::MatrixXd::Zero(n, n);
    for (int k = 0; k < n; ++k) {
      cells.push_back(k);
      s(k, k) += 1e3;
      if (k + 1 == n) break;
      s(k, k) += 4e3;
      s(k + 1, k + 1) += 4e3;
      s(k, k + 1) -= 4e3;
      s(k + 1, k) -= 4e3;
    }
    const Eigen::MatrixXd b = 4e-6 * Eigen::MatrixXd::Identity(n, n);
    const Sparse s_lower = Sparse(s.sparseView()).triangularView<Eigen::Lower>();
    const Sparse b_sparse = b.sparseView();
    factor = std::make_unique<CoupledFactor>(*FactorAnalysis::create(s_lower, Sparse(0, n)));
    EXPECT_TRUE(factor->factorise(s_lower, b_sparse, Precision::kDouble));
    c = b * s.llt().solve(b.transpose());
    walls.dense = nullptr;
    walls.tissue = factor.get();
    walls.tissue_cells = &cells;
    walls.diagonal = factor->lumped_compliance();
  }
};

TEST(DiagonalPressureRoute, GivesTheAnswerOfADenseSolve) {
  SpringCase springs;
  DiagonalPressureRoute route;
  route.set_walls(springs.walls);
  springs.take_thickness(1e-3, 0.01);
  expect_solved(springs, route, springs.hold_none(), 1e-11);
  expect_solved(springs, route, springs.hold_every_fifth(), 1e-11);
  springs.take_thickness(2e-3, 0.01);
  expect_solved(springs, route, springs.hold_none(), 1e-11);
}

TEST(DiagonalPressureRoute, ARigidFilmKeepsThePressureOfItsFirstCell) {
  SpringCase rigid;
  rigid.walls.diagonal.setZero();
  rigid.take_thickness(1e-3, 0.01);
  // All cells wet, so that the film is one piece.
  const Eigen::VectorXd volume = 1e-3 * rigid.metric.area;
  rigid.projection.set_thickness(volume, Eigen::VectorXd::Zero(rigid.grid.n_edges()));
  PressureSystem system({&rigid.projection});
  system.set_compliance(rigid.walls.diagonal);
  ASSERT_EQ(system.gauge_cells(), std::vector<int>{0});
  const std::vector<char> held = rigid.hold_none();
  system.linearise(Eigen::VectorXd::Zero(rigid.n), held);
  Eigen::VectorXd r = Eigen::VectorXd::Zero(rigid.n);
  r[10] = 1e-9;
  r[30] = -1e-9;
  DiagonalPressureRoute route;
  route.set_walls(rigid.walls);
  Eigen::VectorXd dp, moved;
  ASSERT_TRUE(route.solve(system, r, 0.0, dp, moved));
  EXPECT_LT(std::abs(dp[0]), 1e-9 * dp.cwiseAbs().maxCoeff());
  EXPECT_TRUE(moved.isZero(0.0));
  Eigen::VectorXd left = Eigen::VectorXd::Zero(rigid.n);
  system.add_mobility(dp, left);
  EXPECT_LT((left - r).norm(), 1e-9 * r.norm());
}

TEST(DensePressureRoute, GivesTheAnswerOfADenseSolve) {
  PressureCase tissue(kFew);
  DensePressureRoute route;
  route.set_walls(tissue.walls);
  tissue.take_thickness(1e-3, 0.01);
  expect_solved(tissue, route, tissue.hold_none(), 1e-11);
  expect_solved(tissue, route, tissue.hold_every_fifth(), 1e-11);
}

TEST(DensePressureRoute, WallsThatGiveWayBackwardsAreRefused) {
  PressureCase tissue(kFew, -1e-12);
  DensePressureRoute route;
  route.set_walls(tissue.walls);
  tissue.take_thickness(0.0, 0.01);
  PressureSystem system({&tissue.projection});
  system.set_compliance(tissue.c.diagonal());
  const std::vector<char> held = tissue.hold_none();
  system.linearise(Eigen::VectorXd::Zero(tissue.n), held);
  Eigen::VectorXd dp, moved;
  EXPECT_FALSE(route.solve(system, Eigen::VectorXd::Ones(tissue.n), 0.0, dp, moved));
}

TEST(LaggedPressureRoute, AnOldMobilityCostsIterationsNotTheAnswer) {
  for (const double height_now : {1.0e-3, 1.05e-3, 1.2e-3}) {
    PressureCase tissue(kMany);
    LaggedPressureRoute route;
    route.set_walls(tissue.walls);
    ASSERT_TRUE(route.is_lagged());
    const std::vector<Eigen::VectorXd> mobility = {tissue.take_thickness(1e-3, 0.01)};
    route.renew_preconditioner(PressureSystem({&tissue.projection}), mobility);
    tissue.take_thickness(height_now, 0.01);
    expect_solved(tissue, route, tissue.hold_none(), 1e-4);
    EXPECT_EQ(route.counts().fallbacks, 0);
    EXPECT_LE(route.counts().iterations, height_now == 1e-3 ? 5 : 14);
  }
}

TEST(LaggedPressureRoute, HeldCellsKeepTheirPressure) {
  PressureCase tissue(kMany);
  LaggedPressureRoute route;
  route.set_walls(tissue.walls);
  const std::vector<Eigen::VectorXd> mobility = {tissue.take_thickness(1e-3, 0.01)};
  route.renew_preconditioner(PressureSystem({&tissue.projection}), mobility);
  std::vector<char> two = tissue.hold_none();
  two[3] = two[100] = 1;
  expect_solved(tissue, route, two, 1e-4);
  EXPECT_EQ(route.counts().fallbacks, 0);
  // So many that the factor is too far off.
  expect_solved(tissue, route, tissue.hold_every_fifth(), 1e-11);
  EXPECT_EQ(route.counts().fallbacks, 1);
}

TEST(LaggedPressureRoute, ADryFilmAndAMobilityOfAnotherWorldFallBackToTheDirectSolve) {
  PressureCase tissue(kMany);
  LaggedPressureRoute route;
  route.set_walls(tissue.walls);
  const std::vector<Eigen::VectorXd> mobility = {tissue.take_thickness(30e-3, 100.0)};
  route.renew_preconditioner(PressureSystem({&tissue.projection}), mobility);
  tissue.take_thickness(0.0, 0.01);
  expect_solved(tissue, route, tissue.hold_none(), 1e-11);
  EXPECT_EQ(route.counts().fallbacks, 1);
}

TEST(ImplicitPressureRoute, GivesTheAnswerOfADenseSolve) {
  ChainCase chain;
  ImplicitPressureRoute route;
  route.set_walls(chain.walls);
  chain.take_thickness(1e-3, 0.01);
  expect_solved(chain, route, chain.hold_none(), 1e-6);
  expect_solved(chain, route, chain.hold_every_fifth(), 1e-6);
  EXPECT_EQ(route.counts().iterative_solves, 2);
  EXPECT_GT(route.counts().iterations, 0);
}

}  // namespace
}  // namespace lipofill::coupling
