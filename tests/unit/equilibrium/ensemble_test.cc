// Members of an ensemble: the shapes of their own plans, in any order, without factors of their
// own.

#include "core/equilibrium/ensemble.h"

#include <gmock/gmock.h>

#include "tests/unit/equilibrium/small_equilibrium.h"

namespace lipofill::equilibrium {
namespace {

constexpr double kMillilitre = 1e-6;

struct EnsembleCase : SmallEquilibrium {
  std::unique_ptr<Equilibrium> equilibrium = *Equilibrium::create(*model, films, cells, *system, geometry, load, cost);
  Ensemble ensemble{*equilibrium, with(0.3 * kMillilitre), springs, 1e-3};

  MemberChange change(double first_layer, double volume) {
    MemberChange change{Eigen::VectorXd::Ones(system->n_layers()), with(volume).volume};
    change.moduli[0] = first_layer;
    return change;
  }
  /// From rest, as if the member were a plan of its own.
  Settled alone(const MemberChange& change, double tolerance) {
    SmallEquilibrium other;
    EXPECT_TRUE(other.system->scale_moduli(change.moduli).ok());
    PoolTarget target = other.with(0.0);
    target.volume = change.volumes;
    return other.find(target, tolerance);
  }
};

TEST(Ensemble, MembersAreTheShapesOfTheirPlans) {
  EnsembleCase c;
  ASSERT_TRUE(c.ensemble.nominal().is_whole());
  const int before = c.cost.factorisations;
  for (const auto& [modulus, volume] : {std::pair(1.0, 0.3), {1.2, 0.3}, {0.85, 0.28}, {1.1, 0.33}}) {
    SCOPED_TRACE(modulus);
    const MemberChange change = c.change(modulus, volume * kMillilitre);
    const auto member = c.ensemble.find(change);
    ASSERT_TRUE(member.ok()) << member.status();
    const Settled alone = c.alone(change, 1e-9);
    const double lift = (alone.positions - c.system->rest_positions()).colwise().norm().maxCoeff();
    EXPECT_LT((member->positions - alone.positions).colwise().norm().maxCoeff(), 2e-3 * lift);
    EXPECT_NEAR(member->pool_volume[0], change.volumes[0], 1e-12 * change.volumes[0]);
  }
  EXPECT_EQ(c.cost.factorisations, before) << "the nominal factor serves all of them";
}

TEST(Ensemble, AMemberDoesNotDependOnThoseBeforeIt) {
  EnsembleCase first, second;
  const MemberChange wanted = first.change(1.15, 0.31 * kMillilitre);
  const auto alone = first.ensemble.find(wanted);
  for (const double modulus : {0.2, 4.0, 0.9}) {  // the first two are far enough for a factor of their own
    ASSERT_TRUE(second.ensemble.find(second.change(modulus, 0.35 * kMillilitre)).ok());
  }
  const auto after = second.ensemble.find(wanted);
  ASSERT_TRUE(alone.ok() && after.ok());
  EXPECT_EQ(alone->positions, after->positions);
  EXPECT_EQ(alone->cell_pressure, after->cell_pressure);
}

TEST(Ensemble, RefusesAModulusOutOfItsBounds) {
  EnsembleCase c;
  EXPECT_EQ(c.ensemble.find(c.change(-1.0, 0.3 * kMillilitre)).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(c.ensemble.find(c.change(1.0, 0.3 * kMillilitre)).ok());
}

}  // namespace
}  // namespace lipofill::equilibrium
