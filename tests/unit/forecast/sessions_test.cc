// Over-correction and sessions against sums by hand.

#include "core/forecast/sessions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lipofill::forecast {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Retention half() {
  return *Retention::create({RetentionPreset::kPooled, {{6.0, 0.5}, {12.0, 0.5}}, 0.1});
}

ZoneForecast zone(double wanted, double most) {
  ZoneForecast zone;
  zone.wanted = wanted;
  zone.most_at_once = most;
  return zone;
}

TEST(Sessions, InjectsTheWantedVolumeOverItsShare) {
  EXPECT_NEAR(volume_to_inject(half(), 12.0, 2.0, 0.5), 4.0, 1e-5);
  EXPECT_GT(volume_to_inject(half(), 12.0, 2.0, 0.95), 5.5) << "fat that keeps badly takes more";
  EXPECT_LT(volume_to_inject(half(), 12.0, 2.0, 0.05), 3.1);
}

TEST(Sessions, OneWhereNothingBinds) {
  const auto sessions = plan_sessions(half(), {zone(2.0, kInfinity), zone(1.0, 3.0)}, 6.0, 12.0);
  ASSERT_EQ(sessions.size(), 1u);
  EXPECT_NEAR(sessions[0].inject[0], 4.0, 1e-5);
  EXPECT_NEAR(sessions[0].inject[1], 2.0, 1e-5);
}

/// 2 wanted where 3 go in at once: 3, of which 1.5 are left after six months; then 1 more.
TEST(Sessions, FillsUpWhatThePressureAllows) {
  const auto sessions = plan_sessions(half(), {zone(2.0, 3.0)}, 6.0, 12.0);
  ASSERT_EQ(sessions.size(), 2u);
  EXPECT_NEAR(sessions[0].inject[0], 3.0, 1e-5);
  EXPECT_NEAR(sessions[1].present[0], 1.5, 1e-5);
  EXPECT_NEAR(sessions[1].inject[0], 1.0, 1e-5);
  EXPECT_EQ(sessions[1].month, 6.0);
}

TEST(Sessions, SaysSoWhereTheZoneHoldsTooLittle) {
  EXPECT_TRUE(plan_sessions(half(), {zone(2.0, 1.5)}, 6.0, 12.0).empty());
}

TEST(Sessions, MultiplesAreReadBetweenThoseThatWereTried) {
  Eigen::MatrixXd pressures(3, 3);
  pressures << 100.0, 200.0, 400.0,  //
      100.0, 150.0, 180.0,           //
      500.0, 600.0, 700.0;
  const Eigen::VectorXd largest =
      largest_multiples(Eigen::Vector3d(0.5, 1.0, 2.0), pressures, Eigen::Vector3d(300.0, 300.0, 250.0));
  EXPECT_NEAR(largest[0], 1.5, 1e-12);
  EXPECT_EQ(largest[1], kInfinity);
  EXPECT_NEAR(largest[2], 0.25, 1e-12);
}

}  // namespace
}  // namespace lipofill::forecast
