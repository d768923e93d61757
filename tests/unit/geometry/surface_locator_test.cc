#include "core/geometry/surface_locator.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::geometry {
namespace {

/// The triangle found for every vertex of the surface: six of them touch it.
std::vector<int> find_triangles_of_vertices(const SurfaceMesh& mesh) {
  const SurfaceLocator locator(mesh);
  std::vector<int> triangles;
  for (int v = 0; v < mesh.n_vertices(); ++v) triangles.push_back(locator.find_nearest(mesh.points.col(v)).triangle);
  return triangles;
}

TEST(SurfaceLocator, FindsTheSameOfSeveralNearestTrianglesEveryTime) {
  const SurfaceMesh mesh = make_sphere_cap(0.1, 1.0, 80);
  const std::vector<int> first = find_triangles_of_vertices(mesh);
  for (int k = 0; k < 20; ++k) EXPECT_EQ(find_triangles_of_vertices(mesh), first);
}

}  // namespace
}  // namespace lipofill::geometry
