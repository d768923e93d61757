// Parts of rectangles inside outlines, and the outlines themselves.

#include "core/geometry/cut_rectangle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lipofill::geometry {
namespace {

Level disc(double xi, double eta, double radius) {
  return [=](const ChartPoint& p) { return radius - std::hypot(p.xi - xi, p.eta - eta); };
}

double area_on_grid(const Level& level, int n) {
  double area = 0.0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const ChartBox box{1.0 * i / n, (i + 1.0) / n, 1.0 * j / n, (j + 1.0) / n};
      area += integrate_inside(box, {level}).one / (n * n);
    }
  }
  return area;
}

TEST(CutRectangle, MomentsOfAHalfPlaneAreThoseOfTheTrapezium) {
  // Inside: s <= 0.3 + 0.4 t.
  const Level level = [](const ChartPoint& p) { return 0.3 + 0.4 * p.eta - p.xi; };
  const RectangleMoments moments = integrate_inside({0.0, 1.0, 0.0, 1.0}, {level});
  EXPECT_NEAR(moments.one, 0.5, 1e-14);
  EXPECT_NEAR(moments.s, 0.5 * (0.09 + 0.12 + 0.16 / 3.0), 1e-14);
  EXPECT_NEAR(moments.t, 0.15 + 0.4 / 3.0, 1e-14);
  EXPECT_NEAR(moments.st, 0.5 * (0.045 + 0.08 + 0.04), 1e-14);
}

TEST(CutRectangle, AllOrNothing) {
  const ChartBox box{0.25, 0.5, 0.5, 0.75};
  const Level inside = [](const ChartPoint&) { return 1.0; };
  const Level at_side = [](const ChartPoint& p) { return p.xi - 0.25 - 1e-17; };
  const Level beside = [](const ChartPoint& p) { return p.xi - 0.5; };
  EXPECT_EQ(integrate_inside(box, {inside}).one, 1.0);
  EXPECT_EQ(integrate_inside(box, {at_side}).st, 0.25) << "round-off is no cut";
  EXPECT_EQ(integrate_inside(box, {beside}).one, 0.0);
  EXPECT_EQ(integrate_inside(box, {inside, beside}).one, 0.0);
}

TEST(CutRectangle, AreaOfADiscConvergesWithSecondOrder) {
  const double exact = std::numbers::pi * 0.31 * 0.31;
  double last = 0.0;
  for (const int n : {8, 16, 32}) {
    const double error = std::abs(area_on_grid(disc(0.47, 0.52, 0.31), n) - exact);
    EXPECT_LT(error, 0.15 / (n * n));
    if (last > 0.0) {
      EXPECT_GT(std::log2(last / error), 1.5);
    }
    last = error;
  }
}

TEST(CutRectangle, GaussSharesIntegrateBilinearFunctionsExactly) {
  const RectangleMoments moments = integrate_inside({0.0, 1.0, 0.0, 1.0}, {disc(0.1, 0.2, 0.6)});
  const std::array<double, 4> share = fit_gauss_shares(moments);
  const double g[2] = {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)};
  RectangleMoments sum;
  for (int k = 0; k < 4; ++k) {
    const double s = g[k & 1];
    const double t = g[k >> 1];
    sum.one += 0.25 * share[k];
    sum.s += 0.25 * share[k] * s;
    sum.t += 0.25 * share[k] * t;
    sum.st += 0.25 * share[k] * s * t;
  }
  EXPECT_NEAR(sum.one, moments.one, 1e-14);
  EXPECT_NEAR(sum.s, moments.s, 1e-14);
  EXPECT_NEAR(sum.t, moments.t, 1e-14);
  EXPECT_NEAR(sum.st, moments.st, 1e-14);
  EXPECT_EQ(fit_gauss_shares({1.0, 0.5, 0.5, 0.25}), (std::array<double, 4>{1.0, 1.0, 1.0, 1.0}));
}

}  // namespace
}  // namespace lipofill::geometry
