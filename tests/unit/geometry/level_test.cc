// Outlines of levels on the chart.

#include "core/geometry/level.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lipofill::geometry {
namespace {

Level disc(double xi, double eta, double radius) {
  return [=](const ChartPoint& p) { return radius - std::hypot(p.xi - xi, p.eta - eta); };
}

double length_of(const OutlineLoop& loop) {
  double length = 0.0;
  for (size_t k = 0; k < loop.size(); ++k) {
    const ChartPoint& next = loop[(k + 1) % loop.size()];
    length += std::hypot(next.xi - loop[k].xi, next.eta - loop[k].eta);
  }
  return length;
}

/// Positive when the loop goes anticlockwise.
double area_of(const OutlineLoop& loop) {
  double twice = 0.0;
  for (size_t k = 0; k < loop.size(); ++k) {
    const ChartPoint& next = loop[(k + 1) % loop.size()];
    twice += loop[k].xi * next.eta - next.xi * loop[k].eta;
  }
  return 0.5 * twice;
}

TEST(FindZero, IsExactForLinesAndCloseForCurves) {
  EXPECT_DOUBLE_EQ(find_zero(-1.0, 3.0, [](double x) { return 4.0 * x - 1.0; }), 0.25);
  EXPECT_NEAR(find_zero(-0.25, 0.75, [](double x) { return x * x - 0.25; }), 0.5, 0.05);
}

TEST(TraceOutline, ACircleIsOneLoopWhoseLengthAndAreaConverge) {
  double last = 0.0;
  for (const int n : {10, 20, 40}) {
    const auto loops = trace_outline(disc(0.5, 0.45, 0.3), n, n);
    ASSERT_EQ(loops.size(), 1u);
    const double error = std::abs(length_of(loops[0]) - 0.6 * std::numbers::pi);
    EXPECT_NEAR(area_of(loops[0]), 0.09 * std::numbers::pi, 1.0 / (n * n)) << "anticlockwise";
    if (last > 0.0) {
      EXPECT_GT(std::log2(last / error), 1.5);
    }
    last = error;
  }
}

TEST(TraceOutline, AHoleGoesClockwise) {
  const Level ring = [](const ChartPoint& p) { return 0.1 - std::abs(std::hypot(p.xi - 0.5, p.eta - 0.5) - 0.3); };
  const auto loops = trace_outline(ring, 40, 40);
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_NEAR(area_of(loops[0]) + area_of(loops[1]), std::numbers::pi * (0.16 - 0.04), 2e-3);
  EXPECT_LT(std::min(area_of(loops[0]), area_of(loops[1])), 0.0);
}

TEST(TraceOutline, ALoopKeepsToTheBorderOfTheChart) {
  const auto loops = trace_outline(disc(0.0, 0.5, 0.3), 20, 20);
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_NEAR(area_of(loops[0]), 0.045 * std::numbers::pi, 4e-3);
}

TEST(TraceOutline, TwoPartsThatMeetInASaddleStayApart) {
  // Inside in the lower left and the upper right of the middle, and not between them.
  const Level saddle = [](const ChartPoint& p) {
    return std::min((p.xi - 0.5) * (p.eta - 0.5) - 0.01, 0.4 - std::max(std::abs(p.xi - 0.5), std::abs(p.eta - 0.5)));
  };
  EXPECT_EQ(trace_outline(saddle, 3, 3).size(), 2u);
}

}  // namespace
}  // namespace lipofill::geometry
