// Retention against the trial it is fitted to, Bayes' rule against the conjugate form and against a
// grid, and curves that are refused.

#include "core/forecast/retention.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace lipofill::forecast {
namespace {

using ::testing::HasSubstr;

Retention preset(RetentionPreset which) {
  return *Retention::create({which, {}, std::nullopt});
}

/// Wu 2018: cotton pad 49/45/43/41 %, centrifuge 41/38/36/34 % after 1, 3, 6, 12 months.
TEST(Retention, TellsBothArmsOfTheTrial) {
  const Retention cotton = preset(RetentionPreset::kCottonPad);
  const Retention centrifuge = preset(RetentionPreset::kCentrifuge);
  const double months[] = {1.0, 3.0, 6.0, 12.0};
  const double of_cotton[] = {0.49, 0.45, 0.43, 0.41}, of_centrifuge[] = {0.41, 0.38, 0.36, 0.34};
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(cotton.share(months[k], 0.41), of_cotton[k], 0.006);
    EXPECT_NEAR(centrifuge.share(months[k], 0.34), of_centrifuge[k], 0.021);
  }
  EXPECT_EQ(cotton.share(0.0, 0.41), 1.0);
}

TEST(Retention, NeverRisesAndStaysWithinZeroAndOne) {
  const Retention retention = preset(RetentionPreset::kPooled);
  for (const double part : {0.001, 0.05, 0.5, 0.95, 0.999}) {
    double before = 1.0;
    for (double month = 0.0; month <= 60.0; month += 0.25) {
      const double share = retention.quantile(month, part);
      EXPECT_LE(share, before);
      EXPECT_GE(share, 0.0);
      before = share;
    }
  }
  EXPECT_LT(retention.quantile(12.0, 0.05), 0.25);
  EXPECT_GT(retention.quantile(12.0, 0.95), 0.7);
  EXPECT_NEAR(retention.mean(12.0), 0.47, 0.005);
}

TEST(Retention, ACurveOfOnesOwnIsALineBetweenItsPoints) {
  const auto own = Retention::create({RetentionPreset::kPooled, {{2.0, 0.6}, {12.0, 0.4}}, 0.1});
  ASSERT_TRUE(own.ok());
  EXPECT_NEAR(own->share(2.0, 0.4), 0.6, 1e-12);
  EXPECT_NEAR(own->share(7.0, 0.4), 0.5, 1e-12);
  EXPECT_NEAR(own->share(30.0, 0.4), 0.4, 1e-12) << "it stays";
  EXPECT_NEAR(own->at_12_months().spread, 0.1, 1e-12);
}

std::string refusal(std::vector<RetentionPoint> points, std::optional<double> spread = {}) {
  const auto created = Retention::create({RetentionPreset::kPooled, std::move(points), spread});
  return std::string(created.status().message());
}

TEST(Retention, RefusesWhatFatCannotDo) {
  EXPECT_THAT(refusal({{3.0, 1.2}}), HasSubstr("points[0].share"));
  EXPECT_THAT(refusal({{3.0, 1.2}}), HasSubstr("no more is left than was injected"));
  EXPECT_THAT(refusal({{3.0, 0.4}, {6.0, 0.5}}), HasSubstr("fat that is lost does not come back"));
  EXPECT_THAT(refusal({{6.0, 0.4}, {3.0, 0.3}}), HasSubstr("must be later than 6"));
  EXPECT_THAT(refusal({{1.0, 0.5}}), HasSubstr("must reach month 3"));
  EXPECT_THAT(refusal({{12.0, 1.0}}), HasSubstr("lose nothing"));
  EXPECT_THAT(refusal({{12.0, std::nan("")}}), HasSubstr("points[0].share"));
  EXPECT_THAT(refusal({}, 0.9), HasSubstr("standard_deviation"));
}

/// A normal prior of m, s and a normal measurement of y, e: 1 / s'^2 = 1 / s^2 + 1 / e^2.
TEST(Retention, AFollowUpAtTwelveMonthsIsTheConjugateForm) {
  const Retention prior = preset(RetentionPreset::kPooled);
  const Retention next = prior.updated_by({12.0, 0.6, 0.04});
  const double s = prior.at_12_months().spread, e = 0.05;  // with 0.03 off the curve
  const double weight = s * s / (s * s + e * e);
  EXPECT_NEAR(next.at_12_months().centre, 0.47 + weight * (0.6 - 0.47), 1e-12);
  EXPECT_NEAR(next.at_12_months().spread, s * e / std::hypot(s, e), 1e-12);
  EXPECT_TRUE(next.is_updated());
}

/// Bayes' rule on a grid of shares, with the prior cut off and the measurement early and low.
TEST(Retention, AFollowUpIsBayesRuleOnAGrid) {
  const Retention prior = preset(RetentionPreset::kAcquiredAtrophy);
  const KeptShare found{3.0, 0.12, 0.06};
  const Retention next = prior.updated_by(found);
  const double error = std::hypot(0.06, 0.03);
  constexpr int kCells = 200000;
  double sum = 0.0, mean = 0.0, p05 = -1.0, p95 = -1.0;
  std::vector<double> weight(kCells);
  const auto at = [](int k) { return 0.03 + 0.97 * (k + 0.5) / kCells; };
  for (int k = 0; k < kCells; ++k) {
    const double off_prior = (at(k) - 0.43) / prior.at_12_months().spread;
    const double off_found = (prior.share(3.0, at(k)) - 0.12) / error;
    weight[k] = std::exp(-0.5 * (off_prior * off_prior + off_found * off_found));
    sum += weight[k];
    mean += weight[k] * at(k);
  }
  double below = 0.0;
  for (int k = 0; k < kCells; ++k) {
    below += weight[k] / sum;
    if (p05 < 0.0 && below >= 0.05) p05 = at(k);
    if (p95 < 0.0 && below >= 0.95) p95 = at(k);
  }
  EXPECT_NEAR(next.at_12_months().quantile(0.05), p05, 2e-5);
  EXPECT_NEAR(next.at_12_months().quantile(0.95), p95, 2e-5);
  EXPECT_NEAR(next.mean(12.0), mean / sum, 1e-4);
}

/// 2,000 patients drawn from the prior, each measured once with noise after three months: the
/// interval at twelve is less than half as long, and still holds 90 of 100.
TEST(Retention, AFollowUpHalvesTheIntervalAndStillCovers) {
  const Retention prior = preset(RetentionPreset::kPooled);
  std::mt19937 random(5);
  const auto uniform = [&] { return (static_cast<double>(random()) + 0.5) / 4294967296.0; };
  constexpr int kPatients = 2000;
  int covered = 0;
  double length = 0.0;
  for (int k = 0; k < kPatients; ++k) {
    const double truth = prior.at_12_months().quantile(uniform());
    const double noise = std::hypot(0.05, 0.03) * normal_quantile(uniform());
    const Retention next = prior.updated_by({3.0, prior.share(3.0, truth) + noise, 0.05});
    const double low = next.quantile(12.0, 0.05), high = next.quantile(12.0, 0.95);
    covered += low <= truth && truth <= high;
    length += (high - low) / kPatients;
  }
  EXPECT_LT(length, 0.5 * (prior.quantile(12.0, 0.95) - prior.quantile(12.0, 0.05)));
  EXPECT_NEAR(covered / static_cast<double>(kPatients), 0.9, 0.02);
}

TEST(Retention, AFollowUpBeyondWhatIsPossibleIsRefused) {
  const auto refused = [](double month, double kept, double error) {
    FieldViolations violations;
    check_follow_up("follow_up", month, kept, error, 4e-6, violations);
    return std::string(violations.to_status().message());
  };
  EXPECT_EQ(refused(3.0, 4.2e-6, 0.2e-6), "") << "noise may take it a little above";
  EXPECT_THAT(refused(3.0, 5e-6, 0.2e-6), HasSubstr("5 mL left of 4 mL"));
  EXPECT_THAT(refused(3.0, -1e-6, 0.2e-6), HasSubstr("beyond what is possible"));
  EXPECT_THAT(refused(3.0, 2e-6, 0.0), HasSubstr("no scan is exact"));
  EXPECT_THAT(refused(0.0, 2e-6, 0.2e-6), HasSubstr("follow_up.month"));
}

}  // namespace
}  // namespace lipofill::forecast
