// Distributions against closed forms, and what is refused.

#include "core/forecast/distribution.h"

#include <gmock/gmock.h>

#include <cmath>

namespace lipofill::forecast {
namespace {

using ::testing::HasSubstr;

TEST(Distribution, QuantilesAreThoseOfTheNormalDistribution) {
  // Abramowitz & Stegun, table 26.5.
  EXPECT_NEAR(normal_quantile(0.95), 1.6448536269514722, 1e-14);
  EXPECT_NEAR(normal_quantile(0.001), -3.0902323061678132, 1e-12);
  EXPECT_NEAR(normal_quantile(1e-10), -6.3613409024040557, 1e-9);
  EXPECT_EQ(normal_quantile(0.5), 0.0);
  for (const double share : {1e-6, 0.02, 0.3, 0.77, 0.9999})
    EXPECT_NEAR(normal_share(normal_quantile(share)), share, 1e-13);
}

TEST(Distribution, WithoutEndsTheQuantilesAreExact) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Distribution normal{Law::kNormal, 2.0, 0.5, -kInfinity, kInfinity};
  EXPECT_NEAR(normal.quantile(0.95), 2.0 + 0.5 * 1.6448536269514722, 1e-12);
  const Distribution log_normal{Law::kLogNormal, 2.0, 0.5, 0.0, kInfinity};
  EXPECT_NEAR(log_normal.quantile(0.05), 2.0 * std::exp(-0.5 * 1.6448536269514722), 1e-12);
}

TEST(Distribution, EndsCutOffAndTheRestKeepsItsShape) {
  const Distribution upper_half{Law::kNormal, 0.0, 1.0, 0.0, 10.0};
  EXPECT_NEAR(upper_half.median(), normal_quantile(0.75), 1e-12);
  EXPECT_GE(upper_half.quantile(1e-12), 0.0);
  const Distribution usual = Distribution::log_normal(1.0, 0.2);
  EXPECT_NEAR(usual.median(), 1.0, 1e-12);
  EXPECT_NEAR(usual.high, std::exp(0.6), 1e-12);
}

TEST(Distribution, UniformAndTriangularAreTheirClosedForms) {
  const Distribution uniform{Law::kUniform, 0.0, 0.0, 2.0, 6.0};
  EXPECT_NEAR(uniform.quantile(0.25), 3.0, 1e-15);
  const Distribution triangular{Law::kTriangular, 1.0, 0.0, 0.0, 4.0};
  EXPECT_NEAR(triangular.quantile(0.25), 1.0, 1e-15) << "the mode has a quarter below it";
  EXPECT_NEAR(triangular.quantile(0.0625), 0.5, 1e-15);
  EXPECT_NEAR(triangular.quantile(1.0 - 0.0625 / 3.0), 3.5, 1e-12);
}

std::string refusal(const Distribution& distribution) {
  FieldViolations violations;
  check_distribution("d", distribution, 0.1, 10.0, "times the thickness", violations);
  return std::string(violations.to_status().message());
}

TEST(Distribution, WhatIsNotPossibleIsNamed) {
  EXPECT_EQ(refusal(Distribution::log_normal(1.0, 0.2)), "");
  EXPECT_THAT(refusal(Distribution::normal(1.0, 0.4)), HasSubstr("less than 0.1 times the thickness is not possible"));
  EXPECT_THAT(refusal({Law::kUniform, 0.0, 0.0, 0.5, 12.0}), HasSubstr("more than 10 times the thickness"));
  EXPECT_THAT(refusal({Law::kUniform, 0.0, 0.0, 2.0, 1.0}), HasSubstr("must be greater than low, which is 2"));
  EXPECT_THAT(refusal({Law::kNormal, 1.0, 0.0, 0.5, 1.5}), HasSubstr("d.spread"));
  EXPECT_THAT(refusal({Law::kNormal, 1.0, 0.01, 5.0, 6.0}), HasSubstr("next to nothing"));
  EXPECT_THAT(refusal({Law::kTriangular, 3.0, 0.0, 1.0, 2.0}), HasSubstr("must lie between low and high"));
  EXPECT_THAT(refusal({Law::kLogNormal, -1.0, 0.2, 0.5, 1.5}), HasSubstr("must be greater than 0"));
  EXPECT_THAT(refusal({Law::kNormal, std::nan(""), 0.2, 0.5, 1.5}), HasSubstr("finite"));
}

}  // namespace
}  // namespace lipofill::forecast
