// Intervals of 90 of 100 hold fresh cases of the same kind: plans of their own on models of their
// own, drawn by random numbers that the ensemble knows nothing of.

#include <gtest/gtest.h>

#include "core/forecast/forecast.h"
#include "tests/verification/forecast/direct_twins.h"
#include "tests/verification/forecast/twin_forecast.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

constexpr int kTwins = 200;
/// 88 to 92 of 100 are as good as 90.
constexpr double kWithin = 0.02;

TEST(Coverage, IntervalsHoldNinetyOfAHundredFreshCases) {
  Case coverage({"forecast/3-coverage", "Intervals of 90 of 100, held against fresh cases",
                 "Two hundred plans of their own, drawn anew from the same distributions, each evenly, and solved from "
                 "rest: 88 to 92 of 100 lie inside."});
  const TwinCase twin_case = make_twin_case();
  const auto made = make_twin_forecast(twin_case, 400);
  ASSERT_TRUE(made.ok()) << made.status();
  ASSERT_EQ(made->failed, 0);
  const auto twins = solve_twins(twin_case, draw_evenly(twin_case.inputs, kTwins, 11), 2);
  const Shares shares = find_shares(made->times.front(), twins);
  coverage.record({"largest lift: share inside", "1", 0.9, shares.lift, kWithin, Bound::kAbsolute});
  coverage.record({"volume of the skin: share inside", "1", 0.9, shares.volume, kWithin, Bound::kAbsolute});
  coverage.record({"pressure: share inside", "1", 0.9, shares.pressure, kWithin, Bound::kAbsolute});
  coverage.record({"lift of a vertex: share inside", "1", 0.9, shares.node, kWithin, Bound::kAbsolute});
}

}  // namespace
}  // namespace lipofill::verification
