// The answer of a held factor, against dense algebra; and the forces that it answers to.

#include "core/equilibrium/held_response.h"

#include "tests/unit/equilibrium/small_equilibrium.h"

namespace lipofill::equilibrium {
namespace {

/// Rows of B summed as a shape has them.
Eigen::MatrixXd rows_of(const Eigen::MatrixXd& b, const Pools& pools, const Shape& shape) {
  Eigen::MatrixXd rows(shape.n_rows(), b.cols());
  for (Eigen::Index k = 0; k < b.cols(); ++k) rows.col(k) = shape.reduce(pools, b.col(k));
  return rows;
}

/// The factor is of the rest, the balance of a bent shape with a closed cell.
struct Late : SmallEquilibrium {
  StaticBalance balance = make_balance();
  HeldResponse response{*tissue_factor, pools};
  Shape shape = bent_shape(0.5e-3);
  Eigen::MatrixXd s0, b0;
  Eigen::VectorXd missing, dx, dp;

  Late() {
    balance.bring_to(at_rest(), springs);
    EXPECT_TRUE(response.renew(balance, springs));
    s0 = Eigen::MatrixXd(system->tissue().system_matrix()).selfadjointView<Eigen::Lower>();
    b0 = balance.derivative();
    shape.closed = {14};
    shape.pressure = Eigen::Vector2d(300.0, 50.0);
    balance.bring_to(shape, springs);
    missing = Eigen::Vector2d(1e-8, -2e-9);
  }
};

TEST(HeldResponse, SolvesForcesAndRowsTogether) {
  Late c;
  EXPECT_TRUE(c.response.is_late(c.balance));
  ASSERT_TRUE(c.response.correct(c.balance, c.shape, c.missing, c.dx, c.dp));
  const Eigen::MatrixXd a0 = rows_of(c.b0, c.pools, c.shape);
  const Eigen::MatrixXd a = rows_of(c.balance.derivative(), c.pools, c.shape);
  EXPECT_LT((c.s0 * c.dx - a0.transpose() * c.dp - c.balance.force()).norm(), 1e-3 * c.balance.force().norm());
  EXPECT_LT((a * c.dx - c.missing).norm(), 1e-12 * c.missing.norm()) << "rows hold whatever the factor leaves";
}

TEST(HeldResponse, VolumesAloneLeaveForcesInBalance) {
  Late c;
  ASSERT_TRUE(c.response.correct_volumes(c.balance, c.shape, c.missing, c.dx, c.dp));
  const Eigen::MatrixXd a0 = rows_of(c.b0, c.pools, c.shape);
  const Eigen::VectorXd of_pressure = a0.transpose() * c.dp;
  EXPECT_LT((c.s0 * c.dx - of_pressure).norm(), 1e-3 * of_pressure.norm());
  EXPECT_LT((rows_of(c.balance.derivative(), c.pools, c.shape) * c.dx - c.missing).norm(), 1e-12 * c.missing.norm());
}

TEST(HeldResponse, APoolAtTheLimitTakesItsPressure) {
  Late c;
  c.shape.is_at_limit[0] = 1;
  c.missing[0] = -120.0;
  ASSERT_TRUE(c.response.correct(c.balance, c.shape, c.missing, c.dx, c.dp));
  EXPECT_NEAR(c.dp[0], -120.0, 1e-9);
  EXPECT_NEAR((rows_of(c.balance.derivative(), c.pools, c.shape) * c.dx)[1], c.missing[1], 1e-12 * 2e-9);
}

/// Heads, contact and weight act as they should: against B^T p and M g by hand.
TEST(StaticBalance, AddsUpWhatActs) {
  SmallEquilibrium c;
  c.load = {{1.0, 0.0, -9.81}, 920.0};
  StaticBalance balance = c.make_balance();
  Shape shape = c.bent_shape(0.5e-3);
  shape.closed = {20};
  shape.pressure = Eigen::Vector2d(300.0, 50.0);
  balance.bring_to(shape, c.springs);
  const film::FilmMetric metric = c.geometry.metric_at(0, balance.positions());
  Eigen::VectorXd p = Eigen::VectorXd::Constant(36, 300.0) + 920.0 * (metric.centre.transpose() * c.load.gravity);
  p[20] += 50.0;
  EXPECT_LT((balance.cell_pressure() - p).norm(), 1e-12 * p.norm());
  Eigen::VectorXd force = balance.derivative().transpose() * p - c.system->tissue().internal_force();
  const std::vector<int>& dofs = c.system->tissue().dof_of_component();
  for (size_t k = 0; k < dofs.size(); ++k) {
    if (dofs[k] >= 0) force[dofs[k]] += c.system->tissue().mass()[k / 3] * c.load.gravity[k % 3];
  }
  EXPECT_LT((balance.force() - force).norm(), 1e-12 * force.norm());
  EXPECT_LT((balance.gap() - c.geometry.rest_volume() - c.system->gaps().volume()).norm(), 1e-20);
}

TEST(StaticBalance, RestIsInBalance) {
  SmallEquilibrium c;
  StaticBalance balance = c.make_balance();
  balance.bring_to(c.at_rest(), c.springs);
  EXPECT_LT(balance.force().norm(), c.system->least_force());
  EXPECT_FALSE(balance.is_folded());
}

}  // namespace
}  // namespace lipofill::equilibrium
