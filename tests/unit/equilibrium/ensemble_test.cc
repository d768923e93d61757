// Members of an ensemble: the shapes of their own plans, in any order, without factors of their
// own.

#include "core/equilibrium/ensemble.h"

#include <gmock/gmock.h>

#include "core/model/thicker_model.h"
#include "tests/unit/equilibrium/small_equilibrium.h"

namespace lipofill::equilibrium {
namespace {

constexpr double kMillilitre = 1e-6;

struct EnsembleCase : SmallEquilibrium {
  std::unique_ptr<Equilibrium> equilibrium = *Equilibrium::create(*model, films, cells, *system, geometry, load, cost);
  Ensemble ensemble{*equilibrium, with(0.3 * kMillilitre), springs, 1e-3};

  MemberChange change(double first_layer, double volume) {
    MemberChange change{Eigen::VectorXd::Ones(system->n_layers()), with(volume).volume, nullptr};
    change.moduli[0] = first_layer;
    return change;
  }
  absl::StatusOr<Settled> find(const MemberChange& change) { return ensemble.find({change})[0]; }
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
    const auto member = c.find(change);
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
  const auto alone = first.find(wanted);
  for (const double modulus : {0.2, 4.0, 0.9}) {  // the first two are far enough for a factor of their own
    ASSERT_TRUE(second.find(second.change(modulus, 0.35 * kMillilitre)).ok());
  }
  const auto after = second.find(wanted);
  ASSERT_TRUE(alone.ok() && after.ok());
  EXPECT_EQ(alone->positions, after->positions);
  EXPECT_EQ(alone->cell_pressure, after->cell_pressure);
}

/// More than go side by side, some of which need a factor of their own.
TEST(Ensemble, AMemberDoesNotDependOnThoseBesideIt) {
  EnsembleCase c;
  std::vector<MemberChange> changes;
  for (int k = 0; k < 20; ++k) changes.push_back(c.change(0.8 + 0.02 * k, (0.28 + 0.002 * k) * kMillilitre));
  changes[3].moduli[0] = 5.0;
  changes[11].moduli[0] = -1.0;
  const auto together = c.ensemble.find(changes);
  ASSERT_EQ(together.size(), changes.size());
  EXPECT_FALSE(together[11].ok());
  for (const size_t k : {0u, 2u, 3u, 12u, 15u, 16u, 19u}) {
    SCOPED_TRACE(k);
    const auto alone = c.find(changes[k]);
    ASSERT_TRUE(alone.ok() && together[k].ok());
    EXPECT_EQ(alone->positions, together[k]->positions);
    EXPECT_EQ(alone->cell_pressure, together[k]->cell_pressure);
    EXPECT_EQ(alone->cost.iterations, together[k]->cost.iterations);
  }
}

/// A member whose layer is thicker: the shape of that plan from rest, with the nominal factor.
TEST(Ensemble, TakesTissueOfAnotherThickness) {
  EnsembleCase c;
  SmallEquilibrium thicker(model::make_thicker(*c.model, 0, 0.08));
  const auto tissue = *Equilibrium::create(*thicker.model, thicker.films, thicker.cells, *thicker.system,
                                           thicker.geometry, thicker.load, thicker.cost);
  const MemberChange change{Eigen::VectorXd::Ones(c.system->n_layers()), thicker.with(0.3 * kMillilitre).volume,
                            tissue.get()};
  const auto member = c.find(change);
  ASSERT_TRUE(member.ok()) << member.status();
  EXPECT_EQ(thicker.cost.factorisations, 0) << "the nominal factor serves it";
  const Settled alone = thicker.find(thicker.with(0.3 * kMillilitre), 1e-9);
  const double lift = (alone.positions - thicker.system->rest_positions()).colwise().norm().maxCoeff();
  EXPECT_LT((member->positions - alone.positions).colwise().norm().maxCoeff(), 2e-3 * lift);
  EXPECT_NEAR(member->pool_head[0], alone.pool_head[0], 2e-3 * alone.pool_head[0]);
  EXPECT_GT(alone.pool_head[0], 1.05 * c.ensemble.nominal().pool_head[0]) << "the thickness matters here";
}

TEST(Ensemble, RefusesTissueOfOtherNodes) {
  EnsembleCase c;
  model::FaceModelSpec finer = simulation::make_small_model_spec();
  finer.n_xi = 14;
  SmallEquilibrium other(*model::build_face_model(finer, nullptr));
  const auto tissue = *Equilibrium::create(*other.model, other.films, other.cells, *other.system, other.geometry,
                                           other.load, other.cost);
  MemberChange change = c.change(1.0, 0.3 * kMillilitre);
  change.tissue = tissue.get();
  EXPECT_EQ(c.find(change).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(Ensemble, RefusesAModulusOutOfItsBounds) {
  EnsembleCase c;
  EXPECT_EQ(c.find(c.change(-1.0, 0.3 * kMillilitre)).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(c.find(c.change(1.0, 0.3 * kMillilitre)).ok());
}

}  // namespace
}  // namespace lipofill::equilibrium
