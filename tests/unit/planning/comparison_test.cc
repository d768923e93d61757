#include "core/planning/comparison.h"

#include <gtest/gtest.h>

#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::planning {
namespace {

geometry::SurfaceMesh make_plate(double size, int n, double height) {
  return geometry::make_sheet(
      n, n, [=](double u, double v) { return Eigen::Vector3d(size * (u - 0.5), size * (v - 0.5), height); });
}

// Planes 1.5 mm apart: every distance is 1.5 mm, both ways.
TEST(Comparison, OfParallelPlanesIsTheirDistance) {
  const auto c = compare_surfaces(make_plate(0.04, 8, 0.0), make_plate(0.2, 50, 0.0015));
  ASSERT_TRUE(c.ok());
  for (const auto* s : {&c->skin_to_target, &c->target_to_skin}) {
    for (const double figure : {s->mean, s->rms, s->median, s->p90, s->p95, s->max}) EXPECT_NEAR(figure, 1.5e-3, 1e-12);
    EXPECT_EQ(s->share_under_1_mm, 0.0);
    EXPECT_EQ(s->share_under_2_mm, 1.0);
  }
  EXPECT_NEAR(c->skin_to_target.signed_mean, -1.5e-3, 1e-12) << "the skin lies inside the target";
  EXPECT_NEAR(c->hausdorff, 1.5e-3, 1e-12);
  EXPECT_NEAR(c->volume.deficit, 0.04 * 0.04 * 1.5e-3, 1e-15);
  EXPECT_EQ(c->volume.excess, 0.0);
  EXPECT_EQ(c->skin_vertices, 81);
  EXPECT_GT(c->target_vertices, 0);
}

// A step: half of the target lies 3 mm above, half 1 mm below; the two ways differ where a side has
// what the other has not.
TEST(Comparison, OfASpikeIsSeenFromTheSideThatHasIt) {
  const geometry::SurfaceMesh plate = make_plate(0.04, 8, 0.0);
  geometry::SurfaceMesh spiked = make_plate(0.2, 50, 0.0);
  const Eigen::Vector3d middle(0.002, 0.002, 0.0);
  Eigen::Index nearest = 0;
  (spiked.points.colwise() - middle).colwise().squaredNorm().minCoeff(&nearest);
  spiked.points(2, nearest) = 0.006;
  const auto c = compare_surfaces(plate, spiked);
  ASSERT_TRUE(c.ok());
  EXPECT_NEAR(c->target_to_skin.max, 0.006, 1e-12);
  EXPECT_LT(c->skin_to_target.max, 0.006);
  EXPECT_NEAR(c->hausdorff, 0.006, 1e-12);
}

TEST(Comparison, RimIsOfBothSurfaces) {
  const geometry::SurfaceMesh skin = make_plate(0.1, 20, 0.0);       // from -50 to 50 mm, 5 mm apart
  const geometry::SurfaceMesh target = make_plate(0.06, 12, 0.001);  // from -30 to 30 mm
  const Eigen::Matrix3Xd none(3, 0);
  Eigen::Matrix3Xd corner(3, 1);
  corner << 0.05, 0.05, 0.0;
  const auto own = find_rim_points(skin.points, target, {corner, none, 0.006});
  ASSERT_TRUE(own.ok());
  EXPECT_EQ(std::count(own->begin(), own->end(), true), 3) << "the corner and its two neighbours";
  corner << 0.03, 0.03, 0.001;
  const auto others = find_rim_points(skin.points, target, {none, corner, 0.002});
  ASSERT_TRUE(others.ok());
  EXPECT_EQ(std::count(others->begin(), others->end(), true), 25) << "all points whose nearest place is the corner";
  const auto nothing = find_rim_points(skin.points, target, {corner, corner, 0.0});
  EXPECT_EQ(std::count(nothing->begin(), nothing->end(), true), 0);
  EXPECT_EQ(find_triangles_without(skin, *own).size(), skin.triangles.size() - 6u + 0u);
}

TEST(Comparison, OfNothingIsZero) {
  const auto c = compare_surfaces({}, make_plate(0.1, 4, 0.0));
  ASSERT_TRUE(c.ok());
  EXPECT_EQ(c->hausdorff, 0.0);
}

}  // namespace
}  // namespace lipofill::planning
