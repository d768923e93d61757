#include "core/geometry/bone_depth.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/field_violations.h"
#include "core/geometry/face_geometry.h"
#include "core/geometry/ray_tree.h"
#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::geometry {
namespace {

constexpr double kRadius = 0.080;
constexpr double kBoneRadius = 0.060;
const Eigen::Vector3d kBoneCentre(0.003, -0.004, 0.006);

/// The skin of a sphere about the origin: n x n cells over 0.8 x 0.8 radians around +x.
LayeredGrid make_spherical_skin(int n) {
  LayeredGrid grid;
  grid.n_xi = grid.n_eta = n;
  grid.nodes = make_sphere_cap(kRadius, 0.8, n).points;
  return grid;
}

SurfaceMesh make_bone(int n) {
  SurfaceMesh bone = make_sphere(kBoneRadius, n);
  bone.points.colwise() += kBoneCentre;
  return bone;
}

/// From R n along -n to the sphere of radius r about c: t = R - n.c - sqrt(r^2 - |c|^2 + (n.c)^2).
double exact_depth(const Eigen::Vector3d& skin) {
  const double along = skin.normalized().dot(kBoneCentre);
  return kRadius - along - std::sqrt(kBoneRadius * kBoneRadius - kBoneCentre.squaredNorm() + along * along);
}

double largest_error(int n, double smoothing) {
  const LayeredGrid grid = make_spherical_skin(n);
  const auto bone = measure_bone_depth(grid, make_bone(8 * n), smoothing);
  EXPECT_TRUE(bone.ok()) << bone.status();
  EXPECT_EQ(bone->measured_share, 1.0);
  double error = 0.0;
  for (int node = 0; node < grid.nodes_per_level(); ++node) {
    error = std::max(error, std::abs(bone->depth[node] - exact_depth(grid.nodes.col(node))));
  }
  return error;
}

TEST(BoneDepth, OfASphereOutOfTheMiddleOfAnotherIsKnown) {
  const double coarse = largest_error(10, 6e-3);
  const double fine = largest_error(20, 3e-3);
  printf("error of the depth, 10 and 20 cells: %.4f and %.4f mm\n", coarse * 1e3, fine * 1e3);
  EXPECT_LT(coarse, 0.2e-3);
  EXPECT_LT(fine, 0.05e-3);
  EXPECT_GT(coarse / fine, 3.0) << "second order";
}

TEST(BoneDepth, DoesNotDependOnTheOrientationOfTheBone) {
  const LayeredGrid grid = make_spherical_skin(8);
  SurfaceMesh bone = make_bone(40);
  const auto outwards = measure_bone_depth(grid, bone, 2e-3);
  for (auto& triangle : bone.triangles) std::swap(triangle[1], triangle[2]);
  const auto inwards = measure_bone_depth(grid, bone, 2e-3);
  ASSERT_TRUE(outwards.ok() && inwards.ok());
  EXPECT_LT((outwards->depth - inwards->depth).cwiseAbs().maxCoeff(), 1e-12);
}

/// The triangles of a bone whose middle lies on the wanted side of a plane.
SurfaceMesh cut(const SurfaceMesh& bone, const Eigen::Vector3d& normal, double offset) {
  SurfaceMesh part{bone.points, {}};
  for (const auto& triangle : bone.triangles) {
    const Eigen::Vector3d middle =
        (bone.points.col(triangle[0]) + bone.points.col(triangle[1]) + bone.points.col(triangle[2])) / 3.0;
    if (middle.dot(normal) < offset) part.triangles.push_back(triangle);
  }
  return part;
}

TEST(BoneDepth, AHoleIsFilledFromAroundWithinTheMeasuredRange) {
  const LayeredGrid grid = make_spherical_skin(20);
  SurfaceMesh bone = make_bone(80);
  std::erase_if(bone.triangles, [&bone](const auto& triangle) {
    const Eigen::Vector3d p = bone.points.col(triangle[0]);
    return p.x() > 0.0 && std::hypot(p.y(), p.z()) < 0.008;
  });
  // The far side of the sphere is farther than bone is looked for.
  const auto depth = measure_bone_depth(grid, bone, 2e-3);
  ASSERT_TRUE(depth.ok()) << depth.status();
  EXPECT_LT(depth->measured_share, 0.95);
  EXPECT_GT(depth->measured_share, 0.80);
  double error = 0.0;
  for (int node = 0; node < grid.nodes_per_level(); ++node) {
    error = std::max(error, std::abs(depth->depth[node] - exact_depth(grid.nodes.col(node))));
  }
  EXPECT_LT(error, 0.5e-3) << "a hole of 16 mm, in which the bone bulges by 0.5 mm";
}

TEST(BoneDepth, TooLittleBoneIsAnErrorWithTheShare) {
  const LayeredGrid grid = make_spherical_skin(20);
  const auto little = measure_bone_depth(grid, cut(make_bone(80), Eigen::Vector3d::UnitZ(), -0.016), 2e-3);
  EXPECT_EQ(little.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(little.status().message()), ::testing::HasSubstr("must be at least 25 %"));
  SurfaceMesh far = make_bone(10);
  far.points.array() += 1.0;
  EXPECT_THAT(std::string(measure_bone_depth(grid, far, 2e-3).status().message()),
              ::testing::HasSubstr("lies under 0.0 %"));
}

TEST(BoneDepth, ABrokenSurfaceIsRefused) {
  const LayeredGrid grid = make_spherical_skin(4);
  SurfaceMesh bone = make_bone(4);
  bone.triangles[3][1] = bone.n_vertices();
  const absl::Status status = measure_bone_depth(grid, bone, 2e-3).status();
  ASSERT_EQ(field_violations_of(status).size(), 1u);
  EXPECT_EQ(field_violations_of(status)[0].field, "scan_region.bone_scan");
  EXPECT_FALSE(measure_bone_depth(grid, SurfaceMesh{}, 0.0).ok());
}

TEST(RayTree, FindsTheFirstOfSeveralSurfaces) {
  SurfaceMesh shells = make_sphere(0.05, 12);
  const SurfaceMesh inner = make_sphere(0.02, 12);
  const int first = shells.n_vertices();
  shells.points.conservativeResize(3, first + inner.n_vertices());
  shells.points.rightCols(inner.n_vertices()) = inner.points;
  for (const auto& [a, b, c] : inner.triangles) shells.triangles.push_back({first + a, first + b, first + c});
  const RayTree rays(shells);
  const Eigen::Vector3d direction = Eigen::Vector3d(-1.0, 0.02, 0.03).normalized();
  EXPECT_NEAR(rays.find_first({0.08, 0, 0}, direction, 1.0), 0.03, 1e-3);
  EXPECT_NEAR(rays.find_first({0.045, 0, 0}, direction, 1.0), 0.025, 1e-3);
  EXPECT_TRUE(std::isinf(rays.find_first({0.08, 0, 0}, direction, 0.02)));
  EXPECT_TRUE(std::isinf(rays.find_first({0.08, 0, 0}, -direction, 1.0)));
  EXPECT_TRUE(rays.is_blocked({0.08, 0, 0}, direction));
}

}  // namespace
}  // namespace lipofill::geometry
