#include "core/geometry/skin_reach.h"

#include <gtest/gtest.h>

#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::geometry {
namespace {

constexpr double kRadius = 0.08;

/// A flat sheet, x and y in [-60, 60] mm, with a narrow dent of a depth in its middle.
SurfaceMesh make_dented_sheet(double depth) {
  return make_sheet(60, 60, [=](double u, double v) {
    const double x = 0.12 * (u - 0.5);
    const double y = 0.12 * (v - 0.5);
    const double r = std::hypot(x - 0.012, y) / 0.006;
    return Eigen::Vector3d(x, y, r < 1.0 ? -depth * (1.0 - r * r) * (1.0 - r * r) : 0.0);
  });
}

TEST(SkinReach, APointNearTheSkinMovesToTheNearestPlace) {
  const SurfaceMesh sphere = make_sphere(kRadius, 40);
  const SkinReach reach(sphere);
  for (const double height : {-0.009, 0.009}) {
    const auto place = reach.reach({0.0, 0.0, kRadius + height});
    ASSERT_TRUE(place.has_value()) << height;
    EXPECT_LT((place->position - Eigen::Vector3d(0.0, 0.0, kRadius)).norm(), 0.3e-3);
    EXPECT_NEAR(place->distance, 0.009, 0.1e-3);
  }
}

TEST(SkinReach, ADeepPointFollowsTheOutwardNormal) {
  const SurfaceMesh sphere = make_sphere(kRadius, 40);
  const SkinReach reach(sphere);
  const Eigen::Vector3d outward = Eigen::Vector3d(1.0, 2.0, 3.0).normalized();
  const auto place = reach.reach((kRadius - 0.025) * outward);
  ASSERT_TRUE(place.has_value());
  EXPECT_LT((place->position - kRadius * outward).norm(), 1.5e-3);
  EXPECT_NEAR(place->distance, 0.025, 0.5e-3);
}

/// The nearest place would be the bottom of the dent, 12 mm aside.
TEST(SkinReach, ADeepPointIsNotDrawnIntoAHollow) {
  const SurfaceMesh sheet = make_dented_sheet(0.010);
  const SkinReach reach(sheet);
  const Eigen::Vector3d point(0.0, 0.0, -0.018);
  EXPECT_GT(reach.find_nearest(point).position.x(), 0.006);
  const auto place = reach.reach(point);
  ASSERT_TRUE(place.has_value());
  EXPECT_LT(place->position.head<2>().norm(), 3e-3);
}

TEST(SkinReach, WhatLiesTooFarAwayHasNoPlace) {
  const SurfaceMesh sphere = make_sphere(kRadius, 20);
  const SkinReach reach(sphere);
  EXPECT_FALSE(reach.reach({0.0, 0.0, kRadius + 0.011}).has_value());
  EXPECT_FALSE(reach.reach({0.0, 0.0, kRadius - 0.050}).has_value());
}

}  // namespace
}  // namespace lipofill::geometry
