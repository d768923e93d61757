#include "server/sessions/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/sessions/session_fixture.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

plan::InjectionSpec more() {
  return {"all", 2e-8, 1e-6, std::nullopt, std::nullopt};
}

TEST(Replay, AHistoryOfNothingIsOver) {
  SessionHistory history;
  history.until_step = 5;
  history.note = "a checkpoint was damaged";
  const Replay none(history, 5);
  EXPECT_FALSE(none.under_way());
  EXPECT_EQ(none.describe(), "a checkpoint was damaged");
  EXPECT_TRUE(Replay(history, 4).under_way()) << "a command took effect at a later step";
  history.stop_reason = "enough";
  EXPECT_TRUE(Replay(history, 5).under_way()) << "the stop is to be repeated";
}

TEST(Replay, RepeatsInjectionsAfterTheirSteps) {
  SessionHistory history;
  history.injections = {{2, more()}, {2, more()}, {4, more()}};
  history.until_step = 6;
  Replay replay(history, 0);
  EXPECT_THAT(replay.describe(), HasSubstr("catching up to step 6"));
  const auto simulation = make_simulation(1.0);
  std::vector<size_t> injections;
  for (uint64_t step = 0; step < 7; ++step) {
    ASSERT_TRUE(replay.repeat(*simulation).ok());
    injections.push_back(simulation->spec().injections.size());
    EXPECT_EQ(replay.has_caught_up(step), step >= 6) << step;
    simulation->advance_step();
  }
  EXPECT_THAT(injections, ::testing::ElementsAre(1, 1, 3, 3, 4, 4, 4));
  replay.end();
  EXPECT_EQ(replay.describe(), "");
}

TEST(Replay, NamesWhatCannotBeRepeated) {
  SessionHistory late;
  late.injections = {{2, more()}};
  const auto simulation = make_simulation(1.0);
  for (int step = 0; step < 3; ++step) simulation->advance_step();
  const absl::Status past = Replay(late, 3).repeat(*simulation);
  EXPECT_TRUE(absl::IsDataLoss(past));
  EXPECT_THAT(past.ToString(), HasSubstr("cannot be repeated at step 3: it is of step 2"));
  SessionHistory strange;
  strange.injections = {{3, {"nowhere", 2e-8, 1e-6, std::nullopt, std::nullopt}}};
  EXPECT_THAT(Replay(strange, 3).repeat(*simulation).ToString(), HasSubstr("cannot be repeated at step 3"));
}

}  // namespace
}  // namespace lipofill::server
