// Mean, intervals and indices of a linear figure of normal inputs, against their exact values.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/forecast/member_run.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using forecast::Distribution;
using forecast::Quantity;
using forecast::UncertainInput;

/// The figure is normal, of mean 3 and variance 0.16 + 0.01 + 0.04.
TEST(LinearFigure, IntervalsAndIndicesAreExact) {
  Case linear({"forecast/2-linear", "A linear figure of normal inputs",
               "y = 3 + 2 x1 - x2 + x3/2 is normal; its quantiles and indices are exact."});
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto input = [](double mean, double deviation) {
    return UncertainInput{
        Quantity::kZoneVolume, "", {forecast::Law::kNormal, mean, deviation, -kInfinity, kInfinity}, "", false};
  };
  const forecast::Design design = forecast::draw_design({input(1.0, 0.2), input(2.0, 0.1), input(0.0, 0.4)}, 4000);
  const Eigen::VectorXd y = (design.values * Eigen::Vector3d(2.0, -1.0, 0.5)).array() + 3.0;
  const forecast::Spread spread = forecast::summarise(y);
  const double deviation = std::sqrt(0.21);
  linear.record({"4000 members: mean", "1", 3.0, spread.mean, 1e-3, Bound::kRelative});
  linear.record(
      {"4000 members: standard deviation", "1", deviation, spread.standard_deviation, 5e-3, Bound::kRelative});
  linear.record(
      {"4000 members: 5 % quantile", "1", 3.0 - 1.6448536269514722 * deviation, spread.p05, 0.01, Bound::kAbsolute});
  linear.record(
      {"4000 members: 95 % quantile", "1", 3.0 + 1.6448536269514722 * deviation, spread.p95, 0.01, Bound::kAbsolute});
  const forecast::Influences found = forecast::find_influences(design.standard, design.is_gaussian, y);
  const double exact[] = {0.16 / 0.21, 0.01 / 0.21, 0.04 / 0.21};
  for (int k = 0; k < 3; ++k) {
    linear.record({with_number("4000 members: S%g", k + 1), "1", exact[k], found.of_input[k].first_order, 1e-6,
                   Bound::kAbsolute});
  }
}

}  // namespace
}  // namespace lipofill::verification
