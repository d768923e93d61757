// The settled shape found directly: in balance, with the volumes asked for, equal for equal
// questions; cells that close; suction; and where the path ends.

#include "core/equilibrium/equilibrium.h"

#include <gmock/gmock.h>

#include "tests/unit/equilibrium/small_equilibrium.h"

namespace lipofill::equilibrium {
namespace {

constexpr double kMillilitre = 1e-6;

TEST(Equilibrium, BalancesForcesAndHoldsTheVolume) {
  SmallEquilibrium c;
  const PoolTarget target = c.with(0.3 * kMillilitre);
  const Settled settled = c.find(target, 1e-8);
  ASSERT_TRUE(settled.is_whole()) << settled.reason;
  EXPECT_LE(settled.force_error, 1e-8);
  EXPECT_NEAR(settled.pool_volume[0], target.volume[0], 1e-12 * target.volume[0]);
  EXPECT_GT(settled.pool_head[0], 0.0);
  EXPECT_TRUE(settled.closed.empty());
  EXPECT_LT((settled.cell_pressure.array() - settled.pool_head[0]).abs().maxCoeff(), 1e-12);
  // By hand: f_int = B^T p.
  c.system->bring_forces_to(settled.positions, c.springs, 1.0);
  c.system->evaluate_gaps(settled.positions);
  const Eigen::VectorXd of_film = c.system->gaps().derivative().transpose() * settled.cell_pressure;
  EXPECT_LT((of_film - c.system->tissue().internal_force()).norm(), 1e-7 * of_film.norm());
}

TEST(Equilibrium, ToleranceBoundsTheError) {
  SmallEquilibrium c;
  const Settled exact = c.find(c.with(0.3 * kMillilitre), 1e-9);
  const Settled rough = c.find(c.with(0.3 * kMillilitre), 1e-3);
  const double lift = (exact.positions - c.system->rest_positions()).colwise().norm().maxCoeff();
  EXPECT_LT((exact.positions - rough.positions).colwise().norm().maxCoeff(), 2e-3 * lift);
  EXPECT_LT(rough.cost.iterations, exact.cost.iterations);
}

/// It has no memory: other questions before and between change nothing.
TEST(Equilibrium, EqualQuestionsGiveEqualBits) {
  SmallEquilibrium c;
  auto equilibrium = Equilibrium::create(*c.model, c.films, c.cells, *c.system, c.geometry, c.load, c.cost);
  ASSERT_TRUE(equilibrium.ok());
  const Settled first = (*equilibrium)->find(c.with(0.3 * kMillilitre), c.springs, 1e-3);
  (*equilibrium)->find(c.with(-0.02 * kMillilitre), c.springs, 1e-3);
  const Settled again = (*equilibrium)->find(c.with(0.3 * kMillilitre), c.springs, 1e-3);
  EXPECT_EQ(first.positions, again.positions);
  EXPECT_EQ(first.cell_pressure, again.cell_pressure);
  SmallEquilibrium other;
  EXPECT_EQ(other.find(other.with(0.3 * kMillilitre), 1e-3).positions, first.positions);
}

/// Most of the pre-wetted fat is taken out: the middle of the film closes and bears pressure.
TEST(Equilibrium, CellsCloseAndBearPressure) {
  SmallEquilibrium c;
  const PoolTarget target = c.with(-0.9 * c.geometry.rest_volume().sum());
  const Settled settled = c.find(target, 1e-6);
  ASSERT_TRUE(settled.is_whole()) << settled.reason;
  EXPECT_FALSE(settled.closed.empty());
  EXPECT_LT(settled.closed.size(), 36u);
  EXPECT_GE(settled.cell_volume.minCoeff(), 0.0);
  EXPECT_NEAR(settled.pool_volume[0], target.volume[0], 1e-9 * target.volume[0]);
  for (const int cell : settled.closed) {
    EXPECT_LT(settled.cell_volume[cell], 1e-9 * settled.cell_volume.maxCoeff());
    EXPECT_GE(settled.cell_pressure[cell], settled.pool_head[0]) << "walls push, they do not pull";
  }
}

TEST(Equilibrium, SuctionOpensAVoid) {
  SmallEquilibrium c;
  PoolTarget target = c.with(-0.5 * c.geometry.rest_volume().sum());
  const double pressure = c.find(target, 1e-6).pool_head[0];
  ASSERT_LT(pressure, 0.0);
  target.lowest_head = 0.5 * pressure;
  const Settled settled = c.find(target, 1e-6);
  ASSERT_TRUE(settled.is_whole()) << settled.reason;
  EXPECT_NEAR(settled.pool_head[0], target.lowest_head, 1e-9 * -pressure);
  EXPECT_GT(settled.pool_volume[0], target.volume[0]);
  EXPECT_EQ(settled.fat_volume[0], target.volume[0]);
}

/// Gravity along the film: pressure grows downwards by rho g, the head stays one.
TEST(Equilibrium, GravityGivesOneHeadNotOnePressure) {
  SmallEquilibrium c;
  c.load = {{-9.81, 0.0, 0.0}, 920.0};
  const Settled settled = c.find(c.with(0.3 * kMillilitre), 1e-6);
  ASSERT_TRUE(settled.is_whole()) << settled.reason;
  const film::FilmMetric metric = c.geometry.metric_at(0, settled.positions);
  const double apart = metric.centre(0, 5) - metric.centre(0, 0);
  EXPECT_NEAR(settled.cell_pressure[0] - settled.cell_pressure[5], 920.0 * 9.81 * apart, 1e-9);
}

/// Far more than a soft plate can take: the answer is the last good shape, and says how far it
/// goes.
TEST(Equilibrium, WhereThePathEndsTheLastShapeIsTheAnswer) {
  SmallEquilibrium c;
  const PoolTarget target = c.with(400.0 * kMillilitre);
  const Settled settled = c.find(target, 1e-3);
  ASSERT_FALSE(settled.is_whole());
  EXPECT_FALSE(settled.reason.empty());
  EXPECT_GT(settled.share, 0.0);
  EXPECT_LE(settled.force_error, 1e-3);
  const double reached = c.with(settled.share * 400.0 * kMillilitre).volume[0];
  EXPECT_NEAR(settled.pool_volume[0], reached, 1e-12 * reached);
  c.system->bring_forces_to(settled.positions, c.springs, 1.0);
  EXPECT_FALSE(c.system->tissue().is_folded());
}

/// Against the difference of two shapes found from nothing; and the volume that it brings is one.
TEST(Equilibrium, DerivativesAreThoseOfItsShapes) {
  SmallEquilibrium c;
  auto equilibrium = Equilibrium::create(*c.model, c.films, c.cells, *c.system, c.geometry, c.load, c.cost);
  ASSERT_TRUE(equilibrium.ok());
  const double volume = 0.3 * kMillilitre;
  const PoolTarget target = c.with(volume);
  const Settled settled = (*equilibrium)->find(target, c.springs, 1e-3);
  const int before = c.cost.factorisations;
  const auto derivatives = (*equilibrium)->differentiate(target, settled, c.springs);
  ASSERT_EQ(derivatives.size(), 1u);
  EXPECT_LE(c.cost.factorisations, before + 2);
  const double step = 0.01 * volume;
  const Eigen::Matrix3Xd more = (*equilibrium)->find(c.with(volume + step), c.springs, 1e-9).positions;
  const Eigen::Matrix3Xd less = (*equilibrium)->find(c.with(volume - step), c.springs, 1e-9).positions;
  const Eigen::Matrix3Xd expected = (more - less) / (2.0 * step);
  EXPECT_LT((derivatives[0] - expected).colwise().norm().maxCoeff(), 1e-2 * expected.colwise().norm().maxCoeff());
}

}  // namespace
}  // namespace lipofill::equilibrium
