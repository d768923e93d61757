#include "core/geometry/surface_distance.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::geometry {
namespace {

SurfaceMesh make_plate(double z, double size, int n) {
  return make_sheet(n, n, [=](double u, double v) { return Eigen::Vector3d(size * (u - 0.5), size * (v - 0.5), z); });
}

TEST(SurfaceDistance, IsSignedByTheSideOfAPlane) {
  Eigen::Matrix3Xd points(3, 3);
  points << 0.003, 0, 0, 0, 0, 0.001, 0.002, -0.005, 0;
  const std::vector<double> distances = compute_signed_distances(points, make_plate(0.0, 0.1, 5));
  EXPECT_NEAR(distances[0], 0.002, 1e-12);
  EXPECT_NEAR(distances[1], -0.005, 1e-12);
  EXPECT_NEAR(distances[2], 0.0, 1e-12);
}

TEST(SurfaceDistance, IsSignedRightlyBesideSharpEdges) {
  // Two plates at a sharp ridge: a point outside, over the ridge, is nearest to the edge, in front
  // of one plate and behind the other.
  SurfaceMesh ridge;
  ridge.points.resize(3, 4);
  ridge.points << 0, 0, 0.02, -0.02, -0.05, 0.05, 0, 0, 0, 0, -0.1, -0.1;
  ridge.triangles = {{0, 2, 1}, {0, 1, 3}};
  Eigen::Matrix3Xd points(3, 3);
  points << 0.003, -0.003, 0, 0, 0, 0, 0.01, 0.01, -0.01;
  const std::vector<double> distances = compute_signed_distances(points, ridge);
  EXPECT_GT(distances[0], 0.0);
  EXPECT_GT(distances[1], 0.0);
  EXPECT_LT(distances[2], 0.0);
}

TEST(SurfaceDistance, BetweenConcentricSpheresIsTheirGap) {
  const SurfaceMesh inner = make_sphere(0.050, 24);
  const SurfaceMesh outer = make_sphere(0.053, 24);
  for (const double d : compute_signed_distances(outer.points, inner)) EXPECT_NEAR(d, 0.003, 3e-5);
  for (const double d : compute_signed_distances(inner.points, outer)) EXPECT_NEAR(d, -0.003, 6e-5);
}

TEST(SurfaceDistance, OfSurfaceToItselfIsZero) {
  const SurfaceMesh sphere = make_sphere(0.05, 8);
  EXPECT_LT(compute_distance_statistics(compute_signed_distances(sphere.points, sphere)).max, 1e-9);
}

TEST(SurfaceDistance, StatisticsAreThoseOfTheMagnitudes) {
  std::vector<double> values(100);
  for (int k = 0; k < 100; ++k) values[k] = (k % 2 ? 1 : -1) * 1e-3 * (k + 1);
  const DistanceStatistics statistics = compute_distance_statistics(values);
  EXPECT_NEAR(statistics.mean, 50.5e-3, 1e-12);
  EXPECT_NEAR(statistics.rms, 1e-3 * std::sqrt(338350.0 / 100.0), 1e-12);
  EXPECT_NEAR(statistics.p95, 95e-3, 1e-12);
  EXPECT_NEAR(statistics.max, 100e-3, 1e-12);
  EXPECT_NEAR(statistics.median, 50e-3, 1e-12);
  EXPECT_NEAR(statistics.p90, 90e-3, 1e-12);
  EXPECT_NEAR(statistics.share_under_1_mm, 0.0, 1e-12) << "one value is 1 mm, none is nearer";
  EXPECT_NEAR(statistics.share_under_2_mm, 0.01, 1e-12);
  EXPECT_NEAR(statistics.signed_mean, 0.5e-3, 1e-12);
  EXPECT_EQ(compute_distance_statistics({}).max, 0.0);
}

TEST(SurfaceDistance, OfAPatchLeavesOutWhatLiesBesideIt) {
  const SurfaceMesh patch = make_plate(0.004, 0.04, 8);
  const SurfaceMesh target = make_plate(0.0, 0.2, 50);
  const PatchDistance distance = *compute_patch_distance(patch, target);
  EXPECT_EQ(distance.patch_to_target.size(), static_cast<size_t>(patch.n_vertices()));
  EXPECT_NEAR(distance.patch_to_target_statistics.mean, 0.004, 1e-9);
  EXPECT_NEAR(distance.target_to_patch_statistics.max, 0.004, 1e-9);
  EXPECT_NEAR(distance.target_to_patch_statistics.rms, 0.004, 1e-9);
}

TEST(SurfaceDistance, OfAPatchLeavesOutTheFarSideOfAClosedTarget) {
  const SurfaceMesh whole = make_sphere(0.05, 24);
  SurfaceMesh cap = make_sphere(0.052, 24);
  std::erase_if(cap.triangles, [&](const std::array<int, 3>& t) { return cap.points(2, t[0]) < 0.04; });
  const PatchDistance distance = *compute_patch_distance(cap, whole);
  EXPECT_NEAR(distance.target_to_patch_statistics.max, 0.002, 1e-4);
}

TEST(SurfaceDistance, TheVolumeToAParallelPlateIsExact) {
  const SurfaceMesh target = make_plate(0.0, 0.2, 50);
  const VolumeBetween above = *compute_volume_between(make_plate(0.004, 0.04, 8), target);
  EXPECT_NEAR(above.excess, 0.004 * 0.04 * 0.04, 1e-12);
  EXPECT_EQ(above.deficit, 0.0);
  const VolumeBetween below = *compute_volume_between(make_plate(-0.003, 0.04, 8), target);
  EXPECT_NEAR(below.deficit, 0.003 * 0.04 * 0.04, 1e-12);
  EXPECT_EQ(below.excess, 0.0);
}

/// A plate that is tilted through the target has a wedge on either side; its nearest points lie
/// along the target's normal, so that each wedge is that of the plate's shadow.
TEST(SurfaceDistance, TheVolumeToATiltedPlateIsTwoWedges) {
  SurfaceMesh patch = make_plate(0.0, 0.04, 7);  // the line of change does not run along edges
  const Eigen::Vector3d middle = patch.points.rowwise().mean();
  const double slope = 0.1;
  for (int v = 0; v < patch.n_vertices(); ++v) patch.points(2, v) = slope * (patch.points(0, v) - middle[0]);
  const VolumeBetween volume = *compute_volume_between(patch, make_plate(0.0, 0.2, 50));
  const double wedge = 0.5 * 0.02 * (slope * 0.02) * 0.04;
  EXPECT_NEAR(volume.excess, wedge, 0.01 * wedge);
  EXPECT_NEAR(volume.deficit, wedge, 0.01 * wedge);
}

/// Between concentric spheres: second order in the size of the triangles.
TEST(SurfaceDistance, TheVolumeBetweenSpheresConverges) {
  constexpr double kPi = 3.14159265358979323846;
  const double exact = 4.0 / 3.0 * kPi * (std::pow(0.053, 3) - std::pow(0.05, 3));
  double last_error = 0.0;
  for (const int n : {12, 24, 48}) {
    const VolumeBetween volume = *compute_volume_between(make_sphere(0.05, n), make_sphere(0.053, n));
    EXPECT_EQ(volume.excess, 0.0);
    const double error = std::abs(volume.deficit / exact - 1.0);
    if (last_error > 0.0) {
      EXPECT_GT(std::log2(last_error / error), 1.5) << n;
    }
    last_error = error;
  }
  EXPECT_LT(last_error, 0.01);
}

TEST(SurfaceDistance, IsGivenUpWhereverItIsOnceNobodyWantsIt) {
  const SurfaceMesh patch = make_sphere(0.052, 24);
  const SurfaceMesh target = make_sphere(0.05, 24);
  int n_asked = 0;
  ASSERT_TRUE(compute_patch_distance(patch, target, [&] { return ++n_asked < 0; }).ok());
  EXPECT_GE(n_asked, 3 * patch.n_vertices() / 256) << "in each of its three parts";
  for (int patience = 0; patience < n_asked; ++patience) {
    int n_before = 0;
    const auto given_up = compute_patch_distance(patch, target, [&] { return ++n_before > patience; });
    EXPECT_TRUE(absl::IsCancelled(given_up.status()));
    EXPECT_EQ(n_before, patience + 1) << "asked once more";
  }
}

}  // namespace
}  // namespace lipofill::geometry
