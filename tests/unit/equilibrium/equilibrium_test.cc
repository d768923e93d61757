// The settled shape found directly: in balance, with the volumes asked for, equal for equal
// questions; cells that close; suction; and where the path ends.

#include "core/equilibrium/equilibrium.h"

#include <gmock/gmock.h>

#include <cmath>

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

/// Against the difference of two shapes found from nothing; without another factor.
TEST(Equilibrium, DerivativesByVolumeAreThoseOfItsShapes) {
  SmallEquilibrium c;
  auto equilibrium = Equilibrium::create(*c.model, c.films, c.cells, *c.system, c.geometry, c.load, c.cost);
  ASSERT_TRUE(equilibrium.ok());
  const double volume = 0.3 * kMillilitre;
  (*equilibrium)->find(c.with(volume), c.springs, 1e-3);
  const int before = c.cost.factorisations;
  const auto derivatives = (*equilibrium)->differentiate_by_volume();
  ASSERT_EQ(derivatives.size(), 1u);
  ASSERT_TRUE(derivatives[0].has_value());
  EXPECT_EQ(c.cost.factorisations, before);
  const double step = 0.01 * volume;
  const Settled more = (*equilibrium)->find(c.with(volume + step), c.springs, 1e-9);
  const Settled less = (*equilibrium)->find(c.with(volume - step), c.springs, 1e-9);
  const Eigen::Matrix3Xd expected = (more.positions - less.positions) / (2.0 * step);
  EXPECT_LT((derivatives[0]->displacement - expected).colwise().norm().maxCoeff(),
            1e-2 * expected.colwise().norm().maxCoeff());
  const double head = (more.pool_head[0] - less.pool_head[0]) / (2.0 * step);
  EXPECT_NEAR(derivatives[0]->pool_head[0], head, 1e-2 * head);
}

/// The same by the stiffness of a layer; afterwards the tissue has the stiffness that it had.
TEST(Equilibrium, DerivativesByModulusAreThoseOfItsShapes) {
  SmallEquilibrium c;
  auto equilibrium = Equilibrium::create(*c.model, c.films, c.cells, *c.system, c.geometry, c.load, c.cost);
  ASSERT_TRUE(equilibrium.ok());
  const PoolTarget target = c.with(0.3 * kMillilitre);
  const Settled before = (*equilibrium)->find(target, c.springs, 1e-3);
  const auto derivatives = (*equilibrium)->differentiate({}).by_modulus;
  EXPECT_EQ((*equilibrium)->find(target, c.springs, 1e-3).positions, before.positions);
  ASSERT_EQ(derivatives.size(), static_cast<size_t>(c.system->n_layers()));
  for (int layer = 0; layer < c.system->n_layers(); ++layer) {
    SCOPED_TRACE(layer);
    const auto& derivative = derivatives[static_cast<size_t>(layer)];
    ASSERT_TRUE(derivative.has_value());
    const double share = 0.02;
    const auto find_scaled = [&](double change) {
      Eigen::VectorXd factors = Eigen::VectorXd::Ones(c.system->n_layers());
      factors[layer] = std::exp(change);
      EXPECT_TRUE(c.system->scale_moduli(factors).ok());
      return (*equilibrium)->find(target, c.springs, 1e-9);
    };
    const Settled stiffer = find_scaled(share), softer = find_scaled(-share);
    const Eigen::Matrix3Xd expected = (stiffer.positions - softer.positions) / (2.0 * share);
    EXPECT_LT((derivative->displacement - expected).colwise().norm().maxCoeff(),
              2e-3 * expected.colwise().norm().maxCoeff());
    const double head = (stiffer.pool_head[0] - softer.pool_head[0]) / (2.0 * share);
    EXPECT_NEAR(derivative->pool_head[0], head, 2e-3 * std::abs(head));
    EXPECT_TRUE(c.system->scale_moduli(Eigen::VectorXd::Ones(c.system->n_layers())).ok());
  }
}

/// A drag: once its trend is known a shape costs an iteration, or none, and no factor; forces stay
/// in balance, and volumes exact, however far it goes.
TEST(Equilibrium, LearnsWhereADragGoes) {
  SmallEquilibrium c;
  auto equilibrium = Equilibrium::create(*c.model, c.films, c.cells, *c.system, c.geometry, c.load, c.cost);
  ASSERT_TRUE(equilibrium.ok());
  (*equilibrium)->find(c.with(0.3 * kMillilitre), c.springs, 1e-3);
  const int before = c.cost.factorisations;
  int iterations = 0;
  for (int k = 1; k <= 20; ++k) {
    const PoolTarget target = c.with((0.3 + 0.005 * k) * kMillilitre);
    const Settled followed = (*equilibrium)->follow(target, c.springs, 1e-3);
    EXPECT_LE(followed.force_error, 1e-3);
    EXPECT_NEAR(followed.pool_volume[0], target.volume[0], 1e-12 * target.volume[0]);
    if (k > 3) iterations += followed.cost.iterations;
  }
  EXPECT_LE(iterations, 17);
  EXPECT_EQ(c.cost.factorisations, before);
}

/// Who comes second needs one factor less, and finds the same bits.
TEST(Equilibrium, SharesWhatIsKnownOfTheRest) {
  SmallEquilibrium c;
  const auto create = [&c] {
    return *Equilibrium::create(*c.model, c.films, c.cells, *c.system, c.geometry, c.load, c.cost);
  };
  const PoolTarget target = c.with(2.0 * kMillilitre);
  const auto first = create(), second = create();
  const Settled alone = first->find(target, c.springs, 1e-3);
  const Settled again = second->find(target, c.springs, 1e-3);
  EXPECT_EQ(again.positions, alone.positions);
  EXPECT_EQ(again.cost.factors, alone.cost.factors - 1);
  Eigen::VectorXd stiffer = Eigen::VectorXd::Constant(c.system->n_layers(), 1.5);
  ASSERT_TRUE(c.system->scale_moduli(stiffer).ok());
  EXPECT_EQ(second->find(target, c.springs, 1e-3).cost.factors, alone.cost.factors)
      << "another stiffness, another rest";
}

/// A shape that follows another is the one found from rest, within the tolerance, for less.
TEST(Equilibrium, FollowsAtAFractionOfTheCost) {
  SmallEquilibrium c;
  auto equilibrium = Equilibrium::create(*c.model, c.films, c.cells, *c.system, c.geometry, c.load, c.cost);
  ASSERT_TRUE(equilibrium.ok());
  (*equilibrium)->follow(c.with(0.3 * kMillilitre), c.springs, 1e-3);
  EXPECT_TRUE((*equilibrium)->is_from_rest()) << "there was none to follow";
  const Settled followed = (*equilibrium)->follow(c.with(0.32 * kMillilitre), c.springs, 1e-3);
  EXPECT_FALSE((*equilibrium)->is_from_rest());
  EXPECT_EQ(followed.cost.factors, 0);
  EXPECT_LE(followed.cost.iterations, 3);
  const PoolTarget target = c.with(0.32 * kMillilitre);
  EXPECT_NEAR(followed.pool_volume[0], target.volume[0], 1e-12 * target.volume[0]);
  const Settled exact = (*equilibrium)->find(target, c.springs, 1e-9);
  EXPECT_TRUE((*equilibrium)->is_from_rest());
  const double lift = (exact.positions - c.system->rest_positions()).colwise().norm().maxCoeff();
  EXPECT_LT((exact.positions - followed.positions).colwise().norm().maxCoeff(), 2e-3 * lift);
}

}  // namespace
}  // namespace lipofill::equilibrium
