// Proposals on targets that the model made itself, of volumes that are known; bounds; what is left
// and why; what is refused.

#include "core/planning/proposal.h"

#include <gmock/gmock.h>

#include <cmath>
#include <ctime>
#include <iostream>

#include "core/base/field_violations.h"
#include "core/simulation/simulation.h"
#include "tests/unit/planning/square_case.h"

namespace lipofill::planning {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;

TEST(Proposal, FindsTheVolumesATargetWasMadeOf) {
  const SquareCase c;
  const Proposal found = c.propose();
  ASSERT_EQ(found.volumes.size(), 2u);
  EXPECT_NEAR(found.volumes[0].volume, 0.5 * kMillilitre, 0.002 * kMillilitre);
  EXPECT_NEAR(found.volumes[1].volume, 0.25 * kMillilitre, 0.002 * kMillilitre);
  EXPECT_LT(found.reached.skin_to_target.rms, 0.005 * kMillimetre);
  EXPECT_GT(found.before.skin_to_target.rms, 0.3 * kMillimetre);
  EXPECT_LE(found.cost.solves(), 15);
  EXPECT_TRUE(found.remainders.empty());
}

TEST(Proposal, ItsPlanRunsToTheShapeItTellsOf) {
  const SquareCase c;
  const Proposal found = c.propose();
  auto run = simulation::Simulation::create(c.model, found.plan);
  ASSERT_TRUE(run.ok()) << run.status();
  (*run)->advance_step();
  EXPECT_EQ((*run)->phase(), simulation::Phase::kSettled);
  EXPECT_EQ((*run)->state_hash(), found.state_hash);
}

TEST(Proposal, TheSameRequestHasTheSameBytes) {
  const SquareCase c;
  const Proposal one = c.propose(), other = c.propose();
  EXPECT_EQ(one.state_hash, other.state_hash);
  EXPECT_EQ(one.volumes[0].volume, other.volumes[0].volume);
  EXPECT_EQ(one.volumes[0].standard_error, other.volumes[0].standard_error);
  EXPECT_EQ(one.reached.skin_to_target.rms, other.reached.skin_to_target.rms);
}

TEST(Proposal, KeepsToItsBoundsAndSaysWhichHolds) {
  SquareCase c;
  const Proposal free = c.propose();
  c.request.bounds.zones["left"].high = 0.3 * kMillilitre;
  const Proposal zone = c.propose();
  EXPECT_NEAR(zone.volumes[0].volume, 0.3 * kMillilitre, 1e-9 * kMillilitre);
  EXPECT_EQ(zone.volumes[0].bound, Bound::kMaxZone);
  EXPECT_EQ(zone.volumes[1].bound, Bound::kNone);
  EXPECT_GT(zone.reached.skin_to_target.rms, free.reached.skin_to_target.rms);
  ASSERT_FALSE(zone.remainders.empty());
  EXPECT_EQ(zone.remainders[0].zone, "left");
  EXPECT_EQ(zone.remainders[0].cause, Cause::kBound);

  c.request.bounds = {};
  c.request.bounds.max_total = 0.5 * kMillilitre;
  const Proposal total = c.propose();
  EXPECT_LE(total.total(), 0.5 * kMillilitre);
  EXPECT_GT(total.total(), 0.495 * kMillilitre);
  EXPECT_EQ(total.volumes[0].bound, Bound::kMaxTotal);

  c.request.bounds = {};
  c.request.bounds.max_pressure = 0.6 * free.max_pressure();
  const Proposal pressure = c.propose();
  EXPECT_LE(pressure.max_pressure(), c.request.bounds.max_pressure);
  EXPECT_GT(pressure.max_pressure(), 0.99 * c.request.bounds.max_pressure);
  EXPECT_EQ(pressure.volumes[0].bound, Bound::kMaxPressure);

  c.request.bounds = {};
  c.request.bounds.max_lift = 0.7 * free.max_lift;
  const Proposal lift = c.propose();
  EXPECT_LE(lift.max_lift, c.request.bounds.max_lift);
  EXPECT_GT(lift.max_lift, 0.99 * c.request.bounds.max_lift);
  EXPECT_EQ(lift.volumes[0].bound, Bound::kMaxLift);
}

TEST(Proposal, LeavesOutAZoneThatBringsTooLittle) {
  SquareCase c;
  c.target = make_target(c.model, make_square_plan(0.5 * kMillilitre, 0.02 * kMillilitre), 0.0, 1);
  c.request.worthwhile = 0.05 * kMillimetre;
  const Proposal found = c.propose();
  ASSERT_EQ(found.volumes.size(), 1u);
  EXPECT_EQ(found.volumes[0].zone, "left");
  EXPECT_THAT(found.remarks, Contains(HasSubstr("zone 'right' is left out")));
}

TEST(Proposal, TheCurveRisesFromLittleToMuch) {
  SquareCase c;
  c.request.curve_points = 5;
  const Proposal found = c.propose();
  ASSERT_GE(found.curve.size(), 3u);
  EXPECT_EQ(found.curve[found.proposed_point].total(), found.total());
  for (size_t k = 0; k < found.curve.size(); ++k) {
    EXPECT_GT(found.curve[k].total(), k > 0 ? found.curve[k - 1].total() : 0.0);
    for (const TradeOff& other : found.curve) EXPECT_FALSE(dominates(other, found.curve[k]));
  }
}

TEST(Proposal, ProposesZonesAroundWhatIsMissing) {
  SquareCase c;
  c.request.plan.films.clear();
  c.request.plan.injections.clear();
  c.request.zones.emplace();
  c.request.zones->below_layers = {"skin"};
  c.request.zones->min_deficit = 0.2 * kMillimetre;
  const Proposal found = c.propose();
  ASSERT_GE(found.volumes.size(), 1u);
  EXPECT_TRUE(found.volumes[0].is_proposed);
  EXPECT_EQ(found.volumes[0].below_layer, "skin");
  EXPECT_LT(found.reached.skin_to_target.rms, 0.4 * found.before.skin_to_target.rms);
}

TEST(Proposal, RefusesWithFigures) {
  SquareCase c;
  const geometry::SurfaceMesh target = c.target;
  c.target.points.row(2).array() -= 5.0 * kMillimetre;
  EXPECT_THAT(std::string(c.refusal().message()), HasSubstr("everywhere below the skin"));
  c.target = target;
  c.target.points.row(2).array() += 0.5;
  EXPECT_THAT(std::string(c.refusal().message()), HasSubstr("opposite to 0 % of the skin"));
  c.target = target;
  c.target.points.row(2).array() += 14.0 * kMillimetre;
  EXPECT_THAT(std::string(c.refusal().message()), HasSubstr("half of the skin lies more than 14."));
  c.target = target;

  c.request.plan.films[0].zones = {{"corner", geometry::ChartBox{0.0, 0.15, 0.0, 0.15}}};
  c.request.plan.injections.clear();
  EXPECT_EQ(c.refusal().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(c.refusal().message()), HasSubstr("mL that are missing; place zones under it"));
  c.request.plan = make_square_plan(0.0, 0.0);

  c.request.bounds.each_zone = {1.0 * kMillilitre, 0.5 * kMillilitre};
  EXPECT_EQ(field_violations_of(c.refusal())[0].field, "bounds.max_zone_ml");
  c.request.bounds.each_zone = {0.4 * kMillilitre, 0.5 * kMillilitre};
  c.request.bounds.max_total = 0.7 * kMillilitre;
  EXPECT_EQ(field_violations_of(c.refusal())[0].field, "bounds.max_total_ml");
  c.request.bounds.max_total = kUnbounded;
  c.request.bounds.max_pressure = 10.0;
  EXPECT_THAT(std::string(c.refusal().message()), HasSubstr("no volumes are within the bounds"));
  c.request.bounds = {};
  c.request.bounds.zones["nowhere"] = {};
  EXPECT_EQ(field_violations_of(c.refusal())[0].field, "bounds.zone_bounds[nowhere]");
  c.request.bounds = {};

  c.request.plan.fat_yield_stress = 20.0;
  EXPECT_THAT(std::string(c.refusal().message()), HasSubstr("fat.yield_stress_pa"));
  c.request.plan.fat_yield_stress = 0.0;
  c.request.plan.films.clear();
  EXPECT_EQ(field_violations_of(c.refusal())[0].field, "plan.films");
}

TEST(Proposal, EndsWhenItIsCancelled) {
  const SquareCase c;
  const auto proposal = propose_plan(c.model, c.target, c.request, [](double, const char*) { return false; });
  EXPECT_EQ(proposal.status().code(), absl::StatusCode::kCancelled);
}

/// The bar: on a face at the paper's size, with 0.4 mm of noise on the target.
TEST(Proposal, FindsVolumesThroughTheNoiseOfAScan) {
  const auto model = make_jaw_model(40, 31);
  constexpr double kNoise = 0.4 * kMillimetre;
  for (const unsigned seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    const geometry::SurfaceMesh target =
        make_target(model, make_jaw_plan(3.0 * kMillilitre, 1.5 * kMillilitre), kNoise, seed);
    ProposalRequest request = make_request(make_jaw_plan(0.0, 0.0));
    request.min_deficit = 1.0 * kMillimetre;
    const std::clock_t began = std::clock();
    const auto found = propose_plan(model, target, request, nullptr);
    const double seconds = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
    ASSERT_TRUE(found.ok()) << found.status();
    std::cout << seconds << " s of processor, volumes " << found->volumes[0].volume * 1e6 << " +- "
              << found->volumes[0].standard_error * 1e6 << " and " << found->volumes[1].volume * 1e6 << " +- "
              << found->volumes[1].standard_error * 1e6 << " mL, rms " << found->before.skin_to_target.rms * 1e3
              << " -> " << found->reached.skin_to_target.rms * 1e3 << " mm, " << found->cost.shapes << " shapes, "
              << found->cost.derivatives << " derivatives, " << found->cost.factorisations << " factors\n";
    EXPECT_NEAR(found->volumes[0].volume, 3.0 * kMillilitre, 0.03 * 3.0 * kMillilitre);
    EXPECT_NEAR(found->volumes[1].volume, 1.5 * kMillilitre, 0.03 * 1.5 * kMillilitre);
    EXPECT_LT(found->reached.skin_to_target.rms, kNoise + 0.3 * kMillimetre);
    EXPECT_LE(found->cost.solves(), 15);
  }
}

}  // namespace
}  // namespace lipofill::planning
