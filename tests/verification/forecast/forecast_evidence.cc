// Measures what core/doc/credibility.md says of forecasts, at a size that takes too long for a
// test: Sobol indices against ten thousand runs, and intervals against fresh cases. Prints JSON.
//
//     forecast_evidence RUNS TWINS THREADS
//
// deploy/forecasts runs it. The same arguments give the same bytes, whatever the threads.

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "absl/strings/numbers.h"
#include "nlohmann/json.hpp"
#include "tests/verification/forecast/twin_forecast.h"

namespace lipofill::verification {
namespace {

constexpr int kMembers = 1000;

nlohmann::ordered_json tell(const Shares& shares, size_t cases) {
  return {{"cases", cases},
          {"largest_lift", shares.lift},
          {"skin_volume", shares.volume},
          {"pressure", shares.pressure},
          {"lift_of_a_vertex", shares.node}};
}

int measure(int runs, int twins, int threads) {
  const TwinCase twin_case = make_twin_case();
  const auto made = make_twin_forecast(twin_case, kMembers);
  if (!made.ok()) {
    std::cerr << "forecast_evidence: " << made.status() << "\n";
    return 1;
  }
  const int patients = runs / static_cast<int>(twin_case.inputs.size() + 2);
  const PickedIndices picked = find_indices_by_runs(twin_case, patients, threads);
  nlohmann::ordered_json all = {{"members", made->members}, {"reference_runs", picked.runs}};
  for (int k = 0; k < Twin::kFigures; ++k) {
    const IndexGap gap = find_gap(figure_of(made->times.front(), k), k, picked);
    all["indices"].push_back({{"figure", figure_name(k)},
                              {"largest_difference_first", gap.first},
                              {"largest_difference_total", gap.total},
                              {"standard_error_of_reference", gap.error}});
  }
  const auto fresh = solve_twins(twin_case, draw_evenly(twin_case.inputs, twins, 11), threads);
  all["coverage"] = tell(find_shares(made->times.front(), fresh), fresh.size());
  all["coverage_of_reference"] = tell(find_shares(made->times.front(), picked.patients), picked.patients.size());
  std::cout << all.dump(1) << "\n";
  return ::testing::UnitTest::GetInstance()->ad_hoc_test_result().Failed() ? 1 : 0;
}

}  // namespace
}  // namespace lipofill::verification

int main(int argc, char** argv) {
  int runs = 0, twins = 0, threads = 0;
  if (argc != 4 || !absl::SimpleAtoi(argv[1], &runs) || !absl::SimpleAtoi(argv[2], &twins) ||
      !absl::SimpleAtoi(argv[3], &threads) || runs < 60 || twins < 2 || threads < 1) {
    std::cerr << "forecast_evidence: RUNS (60 at least), TWINS (2 at least) and THREADS are needed\n";
    return 2;
  }
  return lipofill::verification::measure(runs, twins, threads);
}
