#include "core/planning/surface_samples.h"

#include <gtest/gtest.h>

#include "core/geometry/surface_locator.h"
#include "tests/unit/planning/test_heads.h"

namespace lipofill::planning {
namespace {

TEST(SurfaceSamples, AreSpreadByArea) {
  const SkinSurface skin = *extract_skin(make_uneven_head(), "the head");
  const int n = 4000;
  const SurfaceSamples samples = sample_surface(skin, n);
  double above = 0.0;
  for (const auto& t : skin.mesh.triangles) {
    const bool is_above = skin.mesh.points(1, t[0]) + skin.mesh.points(1, t[1]) + skin.mesh.points(1, t[2]) > 0.0;
    if (is_above) above += 0.5 * geometry::compute_area_vector(skin.mesh, t).norm();
  }
  const double share = static_cast<double>((samples.points.row(1).array() > 0.0).count()) / n;
  EXPECT_NEAR(share, above / skin.area, 0.005);
  EXPECT_NEAR(samples.spacing * samples.spacing * n, skin.area, 1e-12);
}

TEST(SurfaceSamples, LieOnTheSurfaceWithNormalsOutwards) {
  const SkinSurface skin = *extract_skin(make_even_head(), "the head");
  const SurfaceSamples samples = sample_surface(skin, 500);
  const geometry::SurfaceLocator locator(skin.mesh);
  for (Eigen::Index k = 0; k < samples.size(); ++k) {
    EXPECT_LT(locator.find_nearest(samples.points.col(k)).distance, 1e-9);
    EXPECT_NEAR(samples.normals.col(k).norm(), 1.0, 1e-12);
    EXPECT_GT(samples.normals.col(k).dot(samples.points.col(k)), 0.0) << "the head is a star around its middle";
  }
}

// The placement of a scan must not change what is compared.
TEST(SurfaceSamples, MoveWithTheSurface) {
  const RigidMotion pose = make_pose();
  const SurfaceSamples here = sample_surface(*extract_skin(make_uneven_head(), "a"), 300);
  const SurfaceSamples there = sample_surface(*extract_skin(move_surface(make_uneven_head(), pose), "b"), 300);
  for (Eigen::Index k = 0; k < here.size(); ++k) {
    EXPECT_LT((pose.apply(here.points.col(k)) - there.points.col(k)).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace lipofill::planning
