// Mean, spread and quantiles of small sets that can be told by hand.

#include "core/forecast/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lipofill::forecast {
namespace {

TEST(Statistics, SmallSetsAreAsByHand) {
  Eigen::VectorXd values(4);
  values << 3.0, 1.0, 4.0, 2.0;
  const Spread spread = summarise(values);
  EXPECT_DOUBLE_EQ(spread.mean, 2.5);
  EXPECT_DOUBLE_EQ(spread.standard_deviation, std::sqrt(5.0 / 3.0));
  EXPECT_DOUBLE_EQ(spread.p50, 2.5);
  EXPECT_DOUBLE_EQ(quantile_of(values, 0.125), 1.0) << "the least stands for the first quarter";
  EXPECT_DOUBLE_EQ(quantile_of(values, 0.25), 1.5);
  EXPECT_DOUBLE_EQ(quantile_of(values, 0.999), 4.0);
}

TEST(Statistics, QuantilesOfAnEvenSetAreThoseOfTheUniformDistribution) {
  Eigen::VectorXd values(1000);
  for (int k = 0; k < 1000; ++k) values[k] = (k * 7 % 1000 + 0.5) / 1000.0;
  const Spread spread = summarise(values);
  EXPECT_NEAR(spread.p05, 0.05, 1e-12);
  EXPECT_NEAR(spread.p95, 0.95, 1e-12);
}

}  // namespace
}  // namespace lipofill::forecast
