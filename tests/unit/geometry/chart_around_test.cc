#include "core/geometry/chart_around.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/clear_rectangle.h"
#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::geometry {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kHalf = 0.060;  // [m] of the sheet

/// A flat sheet in the plane z = 0 as a patch, all of its border the end of the scan.
RegionPatch make_patch() {
  RegionPatch patch;
  patch.mesh = make_sheet(60, 60, [](double u, double v) {
    return Eigen::Vector3d(2.0 * kHalf * (u - 0.5), 2.0 * kHalf * (v - 0.5), 0.0);
  });
  return patch;
}

Footprint make_footprint(double x, double y) {
  return {"zone", "scan_region.around.regions[0]", {x, y, 0.0}, Eigen::Vector3d::UnitX(), 0.015, 0.010};
}

ChartAroundRequest make_request(const RegionPatch& patch, const Footprint& footprint) {
  ChartAroundRequest request;
  request.footprints = {footprint};
  request.margin = 0.012;
  request.up = Eigen::Vector3d::UnitY();
  request.border.assign(patch.mesh.n_vertices(), SkinBorder::kScanEnd);
  return request;
}

/// How far apart the points are that stand for zones and borders [m].
constexpr double kSampling = 1.5e-3;

TEST(ChartAround, IsTheRectangleWithItsMargin) {
  const RegionPatch patch = make_patch();
  const auto around = chart_around(patch, make_request(patch, make_footprint(0.0, 0.0)), 20, 16);
  ASSERT_TRUE(around.ok()) << around.status();
  EXPECT_THAT(around->remarks, IsEmpty());
  // xi runs along +x and eta along +y.
  EXPECT_LT((around->corners[0] - Eigen::Vector3d(-0.027, -0.022, 0.0)).norm(), kSampling);
  EXPECT_LT((around->corners[1] - Eigen::Vector3d(0.027, -0.022, 0.0)).norm(), kSampling);
  EXPECT_LT((around->corners[2] - Eigen::Vector3d(0.027, 0.022, 0.0)).norm(), kSampling);
  EXPECT_EQ(around->chart.points.cols(), 21 * 17);
}

TEST(ChartAround, GivesUpMarginBesideABorderAndSaysSo) {
  const RegionPatch patch = make_patch();
  const auto around = chart_around(patch, make_request(patch, make_footprint(0.040, 0.0)), 20, 16);
  ASSERT_TRUE(around.ok()) << around.status();
  EXPECT_NEAR(around->corners[1].x(), kHalf - 1.5e-3, kSampling);
  EXPECT_THAT(around->remarks, ElementsAre(HasSubstr("mm of skin around them in place of 12.0: a border of the scan")));
}

TEST(ChartAround, AZoneThatTheScanCutsIsRemarkedUpon) {
  const RegionPatch patch = make_patch();
  const auto around = chart_around(patch, make_request(patch, make_footprint(0.052, 0.0)), 20, 16);
  ASSERT_TRUE(around.ok()) << around.status();
  // An ellipse cut at (60 - 1.5 - 52) / 15 of its half-length.
  const double t = 6.5 / 15.0;
  const double share = 0.5 + (std::asin(t) + t * std::sqrt(1.0 - t * t)) / std::numbers::pi;
  EXPECT_THAT(around->remarks, ElementsAre(HasSubstr("Only 0.7")));
  EXPECT_NEAR(share, 0.77, 0.01);
}

TEST(ChartAround, AZoneOfWhichTooLittleIsLeftIsRefusedWithTheBorder) {
  const RegionPatch patch = make_patch();
  const auto around = chart_around(patch, make_request(patch, make_footprint(0.059, 0.0)), 20, 16);
  EXPECT_EQ(around.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(around.status().message()),
              HasSubstr("must be at least 0.6: a border of the scan lies near"));
}

TEST(ChartAround, KeepsClearOfObstacles) {
  const RegionPatch patch = make_patch();
  ChartAroundRequest request = make_request(patch, make_footprint(0.0, 0.0));
  request.obstacles = {{"the mouth", {0.020, 0.0, 0.001}}};
  const auto around = chart_around(patch, request, 20, 16);
  ASSERT_TRUE(around.ok()) << around.status();
  EXPECT_NEAR(around->corners[1].x(), 0.018, kSampling);
  EXPECT_THAT(around->remarks, ElementsAre(HasSubstr("the mouth")));
}

TEST(ChartAround, AnObstacleWithinTheZoneStaysAndIsSaid) {
  const RegionPatch patch = make_patch();
  ChartAroundRequest request = make_request(patch, make_footprint(0.0, 0.0));
  request.obstacles = {{"the eye", {0.005, 0.0, 0.0}}};
  const auto around = chart_around(patch, request, 20, 16);
  ASSERT_TRUE(around.ok()) << around.status();
  EXPECT_NEAR(around->corners[1].x(), 0.027, kSampling);
  EXPECT_THAT(around->remarks, ElementsAre(HasSubstr("reaches over the eye")));
}

TEST(ChartAround, KeepsClearOfSharpBendsWhereItCan) {
  const RegionPatch patch = make_patch();
  ChartAroundRequest request = make_request(patch, make_footprint(0.0, 0.0));
  request.obstacles = {{kSharpBend, {0.020, 0.0, 0.0}}, {kSharpBend, {0.005, 0.0, 0.0}}};
  const auto around = chart_around(patch, request, 20, 16);
  ASSERT_TRUE(around.ok()) << around.status();
  EXPECT_NEAR(around->corners[1].x(), 0.018, kSampling);
  EXPECT_THAT(around->remarks, ElementsAre(HasSubstr("in place of 12.0: a bend of the skin too sharp")))
      << "one within the zone is no news where layers can be laid";
}

TEST(ClearRectangle, TheSideThatKeepsMostMarginMoves) {
  const Rectangle box{{-1.0, -1.0}, {1.0, 1.0}};
  const auto clear = find_clear_rectangle(box, 1.0, {{{1.9, 1.5}, 0.1, true}}, {});
  EXPECT_DOUBLE_EQ(clear.rectangle.high.x(), 1.8);
  EXPECT_DOUBLE_EQ(clear.rectangle.high.y(), 2.0);
  EXPECT_THAT(clear.obstacle_of_side, ElementsAre(-1, 0, -1, -1));
}

}  // namespace
}  // namespace lipofill::geometry
