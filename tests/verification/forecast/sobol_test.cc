// Indices of sparse polynomials, against those of runs: plans of their own, picked and frozen.

#include <gtest/gtest.h>

#include "tests/verification/forecast/twin_forecast.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

/// A and B have so many each, which makes six times as many runs; deploy/forecasts makes 10,000.
constexpr int kPatients = 80;
constexpr double kAllowed = 0.03;

TEST(Sobol, IndicesAreThoseOfRuns) {
  Case sobol(
      {"forecast/4-sobol", "Sobol indices, held against runs",
       "480 plans of their own, solved from rest, by Jansen's pick and freeze: what is allowed is 0.03 and three "
       "standard errors of that reference. deploy/forecasts holds them against 10,000 runs."});
  const TwinCase twin_case = make_twin_case();
  const auto made = make_twin_forecast(twin_case, 400);
  ASSERT_TRUE(made.ok()) << made.status();
  const PickedIndices picked = find_indices_by_runs(twin_case, kPatients, 2);
  for (int k = 0; k < Twin::kFigures; ++k) {
    const IndexGap gap = find_gap(figure_of(made->times.front(), k), k, picked);
    const double allowed = kAllowed + 3.0 * gap.error;
    sobol.record(
        {figure_name(k) + ": largest difference of a first index", "1", allowed, gap.first, 0.0, Bound::kAtMost});
    sobol.record(
        {figure_name(k) + ": largest difference of a total index", "1", allowed, gap.total, 0.0, Bound::kAtMost});
    sobol.record(
        {figure_name(k) + ": largest standard error of the reference", "1", 0.0, gap.error, 0.0, Bound::kReported});
  }
}

}  // namespace
}  // namespace lipofill::verification
