// How a shape answers to a small change: against differences of the balance itself.

#include "core/equilibrium/tangent.h"

#include <gmock/gmock.h>

#include "tests/unit/equilibrium/small_equilibrium.h"

namespace lipofill::equilibrium {
namespace {

constexpr double kMillilitre = 1e-6;

/// Moving along the answer brings the forces and the volumes that were asked for.
TEST(Tangent, BringsWhatIsAskedFor) {
  SmallEquilibrium c;
  StaticBalance balance = c.make_balance();
  HeldResponse response(*c.tissue_factor, c.pools);
  Solver solver(balance, response, c.pools);
  Shape shape = c.at_rest();
  ASSERT_TRUE(solver.solve(c.with(0.3 * kMillilitre), c.springs, 1e-9, shape)) << solver.reason();
  const Eigen::VectorXd gap = shape.reduce(c.pools, balance.gap());
  const Eigen::VectorXd force = balance.force();
  LoadChange change{Eigen::VectorXd::Zero(shape.displacement.size()), Eigen::VectorXd::Constant(1, kMillilitre)};
  change.force[change.force.size() / 2] = 0.1;
  const auto tangent = find_tangents(balance, response, c.pools, shape, c.springs, {change})[0];
  ASSERT_TRUE(tangent.has_value());
  EXPECT_EQ(balance.force(), force) << "the balance is where it was";
  const double h = 1e-4;
  Shape beside = shape;
  beside.displacement += h * tangent->displacement;
  beside.pressure += h * tangent->pressure;
  balance.bring_to(beside, c.springs);
  const Eigen::VectorXd brought = (shape.reduce(c.pools, balance.gap()) - gap) / h;
  EXPECT_NEAR(brought[0], change.volume[0], 0.01 * kMillilitre);
  const Eigen::VectorXd taken_up = (force - balance.force()) / h;
  const Eigen::VectorXd of_film = balance.derivative().transpose() * Eigen::VectorXd::Constant(c.pools.n_cells(), 1.0);
  EXPECT_LT((taken_up - change.force).norm(), 0.01 * of_film.norm() * std::abs(tangent->pressure[0]));
}

/// Down to the bits.
TEST(Tangent, DoesNotDependOnThoseBesideIt) {
  SmallEquilibrium c;
  StaticBalance balance = c.make_balance();
  HeldResponse response(*c.tissue_factor, c.pools);
  Solver solver(balance, response, c.pools);
  Shape shape = c.at_rest();
  ASSERT_TRUE(solver.solve(c.with(0.3 * kMillilitre), c.springs, 1e-6, shape)) << solver.reason();
  const Eigen::Index n = shape.displacement.size();
  const LoadChange volume{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Constant(1, kMillilitre)};
  const LoadChange force{0.1 * Eigen::VectorXd::Unit(n, n / 2), Eigen::VectorXd::Zero(1)};
  const auto together = find_tangents(balance, response, c.pools, shape, c.springs, {volume, force, volume});
  const auto alone = find_tangents(balance, response, c.pools, shape, c.springs, {force});
  ASSERT_TRUE(alone[0] && together[0] && together[1] && together[2]);
  EXPECT_EQ(together[1]->displacement, alone[0]->displacement);
  EXPECT_EQ(together[0]->displacement, together[2]->displacement);
}

/// A pool at the suction limit keeps its pressure, whatever volume is asked of it.
TEST(Tangent, KeepsThePressureOfAPoolAtTheLimit) {
  SmallEquilibrium c;
  PoolTarget target = c.with(-0.5 * c.geometry.rest_volume().sum());
  target.lowest_head = 0.5 * c.find(target, 1e-6).pool_head[0];
  StaticBalance balance = c.make_balance();
  HeldResponse response(*c.tissue_factor, c.pools);
  Solver solver(balance, response, c.pools);
  Shape shape = c.at_rest();
  ASSERT_TRUE(solver.solve(target, c.springs, 1e-6, shape)) << solver.reason();
  ASSERT_EQ(shape.is_at_limit[0], 1);
  LoadChange change{Eigen::VectorXd::Zero(shape.displacement.size()),
                    Eigen::VectorXd::Constant(shape.n_rows(), kMillilitre)};
  change.force[change.force.size() / 2] = 0.1;
  const auto tangent = find_tangents(balance, response, c.pools, shape, c.springs, {change})[0];
  ASSERT_TRUE(tangent.has_value());
  EXPECT_EQ(tangent->pressure[0], 0.0);
  EXPECT_GT(tangent->displacement.norm(), 0.0);
}

}  // namespace
}  // namespace lipofill::equilibrium
