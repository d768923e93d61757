// A forecast of a small plan: what it tells, that nothing but the request decides its bytes, and
// what it refuses.

#include "core/forecast/forecast.h"

#include <gmock/gmock.h>

#include "core/base/units.h"
#include "core/forecast/part_bytes.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::forecast {
namespace {

using ::testing::HasSubstr;

constexpr double kMl = kCubicMetresPerMillilitre;

struct ForecastCase {
  std::shared_ptr<const model::FaceModel> model = simulation::make_small_model();
  ForecastRequest request;

  ForecastCase() {
    request.plan = simulation::make_small_plan();
    request.members = 64;
    request.months = {3.0, 12.0};
    request.session_band = 30.0 * 133.322;
  }
  absl::StatusOr<Forecast> make(int workers = 2, const KeptParts& kept = {}) {
    return make_forecast(model, request, workers, kept, nullptr);
  }
  std::string refusal() { return std::string(make().status().message()); }
};

const ForecastFigure& figure(const ForecastTime& time, FigureKind kind) {
  for (const ForecastFigure& figure : time.figures) {
    if (figure.kind == kind) return figure;
  }
  ADD_FAILURE() << "there is no such figure";
  return time.figures.front();
}

TEST(Forecast, TellsSpreadBandsAndWhatIsLeft) {
  ForecastCase c;
  const auto made = c.make();
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->members, 64);
  EXPECT_EQ(made->failed, 0);
  ASSERT_EQ(made->times.size(), 3u);
  double lift_before = 1.0;
  for (const ForecastTime& time : made->times) {
    const ForecastFigure& lift = figure(time, FigureKind::kMaxLift);
    EXPECT_LT(lift.spread.p05, lift.spread.p50);
    EXPECT_LT(lift.spread.p50, lift.spread.p95);
    EXPECT_LT(lift.spread.p50, lift_before) << "fat is lost";
    lift_before = lift.spread.p50;
    ASSERT_EQ(time.bands.size(), 1u);
    EXPECT_NEAR(time.bands[0].probability.sum(), 1.0, 1e-12);
    ASSERT_EQ(time.lift_p05.size(), c.model->geometry.grid.nodes_per_level());
    EXPECT_LE((time.lift_p05 - time.lift_p95).maxCoeff(), 0.0);
    EXPECT_NEAR(time.lift_p95.maxCoeff(), lift.spread.p95, 0.1 * lift.spread.p95);
  }
  const ForecastFigure& volume = figure(made->times[2], FigureKind::kVolume);
  EXPECT_NEAR(volume.spread.p50, 0.47 * 0.3 * kMl, 0.05 * 0.3 * kMl + 0.15 * kMl) << "with what the film holds at rest";
  ASSERT_EQ(made->zones.size(), 1u);
  EXPECT_NEAR(made->zones[0].remaining / (0.3 * kMl), made->retention.quantile(12.0, 0.5), 1e-9);
  EXPECT_NEAR(made->zones[0].inject * made->retention.quantile(12.0, 0.5), 0.3 * kMl, 1e-9 * kMl);
  EXPECT_FALSE(made->causes.empty());
  EXPECT_FALSE(made->remarks.empty());
}

/// Months later nearly all of the spread of what is left comes from retention.
TEST(Forecast, NamesWhatMattersMost) {
  ForecastCase c;
  c.request.members = 128;
  const auto made = c.make();
  ASSERT_TRUE(made.ok()) << made.status();
  const ForecastFigure& volume = figure(made->times[2], FigureKind::kVolume);
  ASSERT_TRUE(volume.influences.has_value());
  EXPECT_GT(volume.influences->of_input.back().total, 0.9);
  EXPECT_LT(volume.influences->unexplained, 0.01);
  const ForecastFigure& now = figure(made->times[0], FigureKind::kMaxLift);
  EXPECT_NEAR(now.influences->of_input.back().total, 0.0, 0.02) << "at once nothing is lost";
}

TEST(Forecast, OnlyTheRequestDecidesItsBytes) {
  ForecastCase c;
  std::map<int, std::string> parts;
  const KeptParts keeping{[](int) { return std::nullopt; }, [&](int part, const std::string& b) { parts[part] = b; }};
  int loaded = 0;
  const KeptParts kept{[&](int part) -> std::optional<std::string> {
                         ++loaded;
                         return parts.at(part);
                       },
                       nullptr};
  c.request.members = 150;
  const auto one = c.make(1, keeping);
  const auto three = c.make(3);
  const auto again = c.make(1, kept);
  ASSERT_TRUE(one.ok() && three.ok() && again.ok());
  EXPECT_EQ(parts.size(), 2u);
  EXPECT_EQ(loaded, 2);
  EXPECT_EQ(one->content_hash, three->content_hash);
  EXPECT_EQ(one->content_hash, again->content_hash);
  EXPECT_EQ(one->times[1].lift_p95, again->times[1].lift_p95);
  parts[0][200] ^= 1;
  EXPECT_EQ(c.make(1, kept)->content_hash, one->content_hash) << "what is damaged is found again";
}

TEST(Forecast, AFollowUpSharpensTheLaterMonths) {
  ForecastCase c;
  const auto before = c.make();
  c.request.follow_up = FollowUp{3.0, false, 0.6 * 0.3 * kMl, 0.02 * kMl};
  const auto after = c.make();
  ASSERT_TRUE(before.ok() && after.ok());
  const Spread wide = figure(before->times[2], FigureKind::kVolume).spread;
  const Spread narrow = figure(after->times[2], FigureKind::kVolume).spread;
  EXPECT_LT(narrow.p95 - narrow.p05, 0.5 * (wide.p95 - wide.p05));
  EXPECT_GT(narrow.p50, wide.p50) << "more was found than is usual";
  EXPECT_EQ(before->retention.quantile(12.0, 0.9), after->prior.quantile(12.0, 0.9));
}

/// The skin's gain is that of a plan with 55 % of the fat.
TEST(Forecast, FindsTheFatBehindTheSkinsGain) {
  ForecastCase c;
  plan::SimulationSpec less = c.request.plan;
  less.injections[0].volume *= 0.55;
  less.goal = plan::TimeGoal::kSettledShape;
  const auto run = simulation::make_small_simulation(less);
  run->advance_step();
  c.request.follow_up = FollowUp{6.0, true, run->report().skin_volume_change, 1e-3 * kMl};
  c.request.members = 50;
  const auto made = c.make();
  ASSERT_TRUE(made.ok()) << made.status();
  const double error = 0.03;  // a patient is off the curve
  EXPECT_NEAR(made->retention.quantile(6.0, 0.5), 0.55, error);
  EXPECT_GT(made->retention.quantile(6.0, 0.5), 0.53);
}

TEST(Forecast, PlansSessionsWhereThePressureBinds) {
  ForecastCase c;
  const auto free = c.make();
  ASSERT_TRUE(free.ok());
  ASSERT_EQ(free->sessions.size(), 1u);
  const double p95 = figure(free->times[0], FigureKind::kMeanPressure).spread.p95;
  c.request.session_band = 1.2 * p95;
  c.request.wanted = {{"all", 0.3 * kMl}};
  const auto bound = c.make();
  ASSERT_TRUE(bound.ok()) << bound.status();
  EXPECT_LT(bound->zones[0].most_at_once, bound->zones[0].inject);
  ASSERT_GT(bound->sessions.size(), 1u);
  for (const Session& session : bound->sessions) {
    EXPECT_LE(session.inject[0] + session.present[0], bound->zones[0].most_at_once * (1.0 + 1e-9));
  }
  c.request.session_band = 0.1 * p95;
  const auto too_little = c.make();
  ASSERT_TRUE(too_little.ok());
  EXPECT_TRUE(too_little->sessions.empty());
  EXPECT_THAT(too_little->remarks, ::testing::Contains(HasSubstr("are not reached in eight sessions")));
}

TEST(Forecast, RefusesWithFieldsAndFigures) {
  ForecastCase c;
  c.request.members = 20'000;
  c.request.months = {6.0, 3.0};
  EXPECT_THAT(c.refusal(), HasSubstr("members: is 20000, must be in [50, 10000]"));
  EXPECT_THAT(c.refusal(), HasSubstr("months[1]"));
  c = {};
  c.request.retention.points = {{3.0, 1.5}};
  EXPECT_THAT(c.refusal(), HasSubstr("retention.points[0].share"));
  c = {};
  c.request.inputs = {{Quantity::kLayerThickness, "skin", Distribution::normal(1.0, 0.5), "", false}};
  EXPECT_THAT(c.refusal(), HasSubstr("inputs[0].distribution.low"));
  c = {};
  c.request.plan.injections.clear();
  EXPECT_THAT(c.refusal(), HasSubstr("there is nothing to forecast"));
  c = {};
  c.request.wanted = {{"nose", 1e-6}};
  EXPECT_THAT(c.refusal(), HasSubstr("wanted[nose]"));
}

/// Members of a kept part that did not settle: a few are told of, most of them are too many.
TEST(Forecast, SaysWhatShareSettled) {
  ForecastCase c;
  c.request.months = {12.0};
  std::string part;
  ASSERT_TRUE(c.make(2, {nullptr, [&](int, const std::string& bytes) { part = bytes; }}).ok());
  const auto with_failures = [&](size_t n) {
    auto members = *read_part(part, 64);
    for (size_t k = 0; k < n; ++k)
      members[2 * k] = {k < 3 ? "rare" : "a hexahedron of the tissue is turned inside out", {}};
    return c.make(2, {[members](int) { return write_part(members); }, nullptr});
  };
  const auto few = with_failures(8);
  ASSERT_TRUE(few.ok()) << few.status();
  EXPECT_EQ(few->failed, 8);
  ASSERT_EQ(few->failures.size(), 2u);
  EXPECT_EQ(few->failures[0].members, 5);
  EXPECT_EQ(few->failures[0].first, 6);
  EXPECT_EQ(few->failures[1].reason, "rare");
  EXPECT_THAT(few->remarks, ::testing::Contains(HasSubstr("8 of 64 members (12.5 %) did not settle")));
  auto members = *read_part(part, 64);
  for (size_t k = 0; k < 40; ++k) members[k] = {"the tissue folds", {}};
  const auto many = c.make(2, {[members](int) { return write_part(members); }, nullptr});
  EXPECT_EQ(many.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(many.status().message()),
              HasSubstr("24 of 64 members settled, at least half have to; the most frequent reason, in 40 of them: the "
                        "tissue folds"));
}

}  // namespace
}  // namespace lipofill::forecast
