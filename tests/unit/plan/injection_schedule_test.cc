// What a schedule of injections feeds into which cell, when, and how it takes out.

#include "core/plan/injection_schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/base/field_violations.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::plan {
namespace {

using geometry::ChartPoint;
using ::testing::HasSubstr;

constexpr double kMillilitre = 1e-6;
constexpr double kRoundOff = 1e-20;  // [m3]

/// A film of 6 x 6 cells of 8 mm in two zones: columns 0 to 3, and the two that are left.
struct Case {
  std::shared_ptr<const model::FaceModel> model = simulation::make_small_model();
  std::vector<FilmLayout> films;
  InjectionSchedule schedule;
  std::vector<Eigen::VectorXd> received;
  double held = 1e-6;  ///< by every cell [m3]

  explicit Case(FilmWallKind wall = FilmWallKind::kTissue) {
    FilmSpec spec = simulation::make_small_plan().films[0];
    spec.zones = {{"wide", ChartBox{0.0, 2.0 / 3.0, 0.0, 1.0}}, {"narrow", ChartBox{2.0 / 3.0, 1.0, 0.0, 1.0}}};
    films = {*place_film(*model, spec)};
    films[0].wall = wall;
  }

  void add(const InjectionSpec& spec, double now = 0.0) {
    auto placed = schedule.place(*model, films, spec, now);
    ASSERT_TRUE(placed.ok()) << placed.status();
    schedule.add(*std::move(placed));
  }
  std::string refusal(const InjectionSpec& spec, double now = 0.0) {
    const std::vector<FieldViolation> all = field_violations_of(schedule.place(*model, films, spec, now).status());
    EXPECT_EQ(all.size(), 1u);
    return all.empty() ? "" : all[0].field + ": " + all[0].description;
  }
  /// What a step brings in all [m3].
  double deliver(double time, double dt) {
    schedule.deliver(
        films, [this](int, int) { return held; }, time, dt, received);
    return received[0].sum();
  }
};

TEST(InjectionSchedule, FeedsAtItsRateUntilAllIsIn) {
  Case c;
  c.add({"wide", 0.3 * kMillilitre, 1.0 * kMillilitre, 0.1, ChartPoint{0.3, 0.3}});
  EXPECT_NEAR(c.schedule.end(), 0.4, 1e-15);
  EXPECT_EQ(c.deliver(0.0, 0.1), 0.0);
  EXPECT_NEAR(c.deliver(0.1, 0.05), 0.05 * kMillilitre, kRoundOff);
  EXPECT_NEAR(c.received[0][1 * 6 + 1], 0.05 * kMillilitre, kRoundOff) << "all of it at the site";
  EXPECT_NEAR(c.deliver(0.15, 0.2), 0.2 * kMillilitre, kRoundOff);
  EXPECT_NEAR(c.deliver(0.35, 1.0), 0.05 * kMillilitre, kRoundOff) << "the step ends after the injection";
  EXPECT_EQ(c.deliver(1.35, 1.0), 0.0);
  EXPECT_NEAR(c.schedule.delivered(), 0.3 * kMillilitre, kRoundOff);
  EXPECT_EQ(c.schedule.undelivered(2.0), 0.0);
}

TEST(InjectionSchedule, QueuesWhatHasNoStart) {
  Case c;
  c.add({"wide", 0.2 * kMillilitre, 1.0 * kMillilitre, 0.5, std::nullopt});
  c.add({"narrow", 0.3 * kMillilitre, 1.0 * kMillilitre, std::nullopt, std::nullopt});
  EXPECT_NEAR(c.schedule.end(), 1.0, 1e-15) << "0.5 s + 0.2 s + 0.3 s";
  c.add({"narrow", 0.1 * kMillilitre, 1.0 * kMillilitre, std::nullopt, std::nullopt}, 5.0);
  EXPECT_NEAR(c.schedule.end(), 5.1, 1e-15) << "never in the past";
  const std::vector<double> marks{0.5, 0.7, 1.0, 5.0, 5.1};
  double time = 0.0;
  for (const double mark : marks) {
    time = c.schedule.next_change(time);
    EXPECT_NEAR(time, mark, 1e-15);
    time = mark + 1e-12;
  }
  EXPECT_EQ(c.schedule.next_change(time), std::numeric_limits<double>::infinity());
}

/// The zone of four columns has 2 x 4 cells off its edge, which share evenly; the one of two
/// columns has none, so all its cells share.
TEST(InjectionSchedule, SpreadsOverTheInsideOfAZone) {
  Case c;
  c.add({"wide", 0.8 * kMillilitre, 1.0 * kMillilitre, 0.0, std::nullopt});
  c.deliver(0.0, 10.0);
  for (int slot = 0; slot < 36; ++slot) {
    const int i = slot % 6, j = slot / 6;
    const bool is_inside = i >= 1 && i <= 2 && j >= 1 && j <= 4;
    EXPECT_NEAR(c.received[0][slot], is_inside ? 0.1 * kMillilitre : 0.0, kRoundOff) << slot;
  }
  Case narrow;
  narrow.add({"narrow", 1.2 * kMillilitre, 1.0 * kMillilitre, 0.0, std::nullopt});
  narrow.deliver(0.0, 10.0);
  for (int slot = 0; slot < 36; ++slot) {
    EXPECT_NEAR(narrow.received[0][slot], slot % 6 >= 4 ? 0.1 * kMillilitre : 0.0, kRoundOff) << slot;
  }
}

/// A cell gives at most 95 % of what it holds in a step; what is left stays due.
TEST(InjectionSchedule, TakesNoMoreThanThereIs) {
  Case c;
  c.held = 0.1 * kMillilitre;
  c.add({"wide", -0.3 * kMillilitre, 1.0 * kMillilitre, 0.0, ChartPoint{0.3, 0.3}});
  EXPECT_NEAR(c.deliver(0.0, 0.05), -0.05 * kMillilitre, kRoundOff) << "as asked, while there is enough";
  EXPECT_NEAR(c.deliver(0.05, 0.2), -0.095 * kMillilitre, kRoundOff);
  EXPECT_NEAR(c.schedule.undelivered(0.25), -0.105 * kMillilitre, kRoundOff);
  c.held = 10.0 * kMillilitre;
  EXPECT_NEAR(c.deliver(0.25, 1.0), -0.155 * kMillilitre, kRoundOff) << "made up for later";
  EXPECT_NEAR(c.schedule.delivered(), -0.3 * kMillilitre, kRoundOff);
}

TEST(InjectionSchedule, TwoCannulasShareWhatACellHolds) {
  Case c;
  c.held = 0.1 * kMillilitre;
  for (int k = 0; k < 2; ++k) c.add({"wide", -0.08 * kMillilitre, 1.0 * kMillilitre, 0.0, ChartPoint{0.3, 0.3}});
  EXPECT_NEAR(c.deliver(0.0, 1.0), -0.095 * kMillilitre, kRoundOff);
  std::vector<double> each = c.schedule.delivered_each();
  EXPECT_NEAR(each[0], -0.08 * kMillilitre, kRoundOff);
  EXPECT_NEAR(each[1], -0.015 * kMillilitre, kRoundOff);
}

TEST(InjectionSchedule, RigidWallsStayFull) {
  Case c(FilmWallKind::kRigid);
  c.held = 0.1 * kMillilitre;
  c.add({"wide", -0.3 * kMillilitre, 1.0 * kMillilitre, 0.0, ChartPoint{0.3, 0.3}});
  EXPECT_NEAR(c.deliver(0.0, 1.0), -0.3 * kMillilitre, kRoundOff);
}

TEST(InjectionSchedule, GoesOnFromASnapshot) {
  Case c;
  c.add({"wide", 0.3 * kMillilitre, 1.0 * kMillilitre, 0.0, std::nullopt});
  c.deliver(0.0, 0.1);
  const std::vector<double> each = c.schedule.delivered_each();
  const double total = c.schedule.delivered();
  c.deliver(0.1, 0.1);
  c.schedule.restore_delivered(each, total);
  EXPECT_NEAR(c.schedule.delivered(), 0.1 * kMillilitre, kRoundOff);
  EXPECT_NEAR(c.deliver(0.1, 0.1), 0.1 * kMillilitre, kRoundOff);
}

TEST(InjectionSchedule, RefusesWhatNoCannulaCanDo) {
  Case c;
  const InjectionSpec good{"wide", 0.3 * kMillilitre, 1.0 * kMillilitre, std::nullopt, std::nullopt};
  const auto with = [&](auto change) {
    InjectionSpec spec = good;
    change(spec);
    return spec;
  };
  EXPECT_THAT(c.refusal(with([](auto& s) { s.zone = "chin"; })), HasSubstr("zone: is 'chin', which no film has"));
  EXPECT_THAT(c.refusal(with([](auto& s) { s.rate = 0.0; })), HasSubstr("rate_ml_per_s: "));
  EXPECT_THAT(c.refusal(with([](auto& s) { s.volume = std::numeric_limits<double>::quiet_NaN(); })),
              HasSubstr("volume_ml: is not a number"));
  EXPECT_THAT(c.refusal(with([](auto& s) { s.start = 1.0; }), 2.0), HasSubstr("start_s: "));
  // 20 mm on average over 32 x 48 mm are 30.72 mL.
  EXPECT_THAT(c.refusal(with([](auto& s) { s.volume = 30.8 * kMillilitre; })), HasSubstr("holds at most 30.72 mL"));
  EXPECT_THAT(c.refusal(with([](auto& s) { s.site = ChartPoint{0.9, 0.5}; })), HasSubstr("site: lies at (0.9, 0.5)"));
  EXPECT_EQ(c.schedule.end(), 0.0) << "nothing of these was taken in";
  c.add(with([](auto& s) { s.volume = 30.6 * kMillilitre; }));
}

}  // namespace
}  // namespace lipofill::plan
