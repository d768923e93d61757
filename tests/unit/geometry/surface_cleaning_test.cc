#include "core/geometry/surface_cleaning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/surface_reader.h"
#include "core/geometry/surface_topology.h"
#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::geometry {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

SurfaceMesh make_plate() {
  return make_sheet(6, 5, [](double u, double v) { return Eigen::Vector3d(0.06 * u, 0.05 * v, 0.0); });
}

TEST(SurfaceCleaning, LeavesASoundSurfaceAlone) {
  const SurfaceMesh plate = make_plate();
  const CleanedSurface cleaned = clean_surface(plate);
  EXPECT_EQ(cleaned.mesh.triangles, plate.triangles);
  EXPECT_EQ(cleaned.mesh.points, plate.points);
  EXPECT_TRUE(cleaned.remarks.empty());
  for (int v = 0; v < plate.n_vertices(); ++v) EXPECT_EQ(cleaned.vertex_of_scan[v], v);
}

TEST(SurfaceCleaning, MergesVerticesAtOnePlace) {
  SurfaceMesh plate = make_plate();
  const int twin = plate.n_vertices();
  plate.points.conservativeResize(3, twin + 1);
  plate.points.col(twin) = plate.points.col(10);
  for (size_t t = 0; t < 8; ++t) std::replace(plate.triangles[t].begin(), plate.triangles[t].end(), 10, twin);
  ASSERT_GT(check_surface(plate).boundary_loops + check_surface(plate).non_manifold_edges, 0);
  const CleanedSurface cleaned = clean_surface(plate);
  EXPECT_EQ(cleaned.mesh.triangles, make_plate().triangles);
  EXPECT_EQ(cleaned.vertex_of_scan[twin], cleaned.vertex_of_scan[10]);
  EXPECT_THAT(cleaned.remarks, Contains(HasSubstr("1 vertex at the place of another")));
}

TEST(SurfaceCleaning, DropsDegenerateRepeatedAndUnused) {
  SurfaceMesh plate = make_plate();
  plate.points.conservativeResize(3, plate.n_vertices() + 1);
  plate.points.col(plate.n_vertices() - 1) = Eigen::Vector3d(1, 1, 1);
  plate.triangles.push_back({3, 3, 4});
  plate.triangles.push_back({0, 1, 2});  // three points of one line
  plate.triangles.push_back(plate.triangles[7]);
  const CleanedSurface cleaned = clean_surface(plate);
  EXPECT_EQ(cleaned.mesh.triangles, make_plate().triangles);
  EXPECT_EQ(cleaned.vertex_of_scan.back(), -1);
  EXPECT_THAT(cleaned.remarks, Contains(HasSubstr("2 triangles without area")));
  EXPECT_THAT(cleaned.remarks, Contains(HasSubstr("1 triangle given more than once")));
  EXPECT_THAT(cleaned.remarks, Contains(HasSubstr("1 vertex of no triangle")));
}

TEST(SurfaceCleaning, CutsAFinOffANonManifoldEdge) {
  SurfaceMesh plate = make_plate();
  const int tip = plate.n_vertices();
  plate.points.conservativeResize(3, tip + 1);
  plate.points.col(tip) = plate.points.col(9) + Eigen::Vector3d(0, 0, 0.01);
  plate.triangles.push_back({9, 16, tip});
  ASSERT_EQ(check_surface(plate).non_manifold_edges, 1);
  const CleanedSurface cleaned = clean_surface(plate);
  EXPECT_EQ(cleaned.mesh.triangles, make_plate().triangles);
  EXPECT_THAT(cleaned.remarks, Contains(HasSubstr("1 edge of more than two triangles")));
}

TEST(SurfaceCleaning, DropsSpecksAndKeepsParts) {
  SurfaceMesh speck = make_sphere_cap(0.002, 1.0, 2);
  SurfaceMesh part = make_sphere_cap(0.03, 1.0, 4);
  const CleanedSurface cleaned = clean_surface(put_together(put_together(make_plate(), speck), part));
  EXPECT_EQ(check_surface(cleaned.mesh).components, 2);
  EXPECT_THAT(cleaned.remarks, Contains(HasSubstr("1 small loose part (8 triangles)")));
}

TEST(SurfaceCleaning, TurnsTrianglesTheWayOfTheMajority) {
  SurfaceMesh plate = make_plate();
  for (const size_t t : {3u, 11u, 12u}) std::swap(plate.triangles[t][1], plate.triangles[t][2]);
  const CleanedSurface cleaned = clean_surface(plate);
  for (const auto& triangle : cleaned.mesh.triangles) EXPECT_GT(compute_area_vector(cleaned.mesh, triangle).z(), 0.0);
  EXPECT_THAT(cleaned.remarks, Contains(HasSubstr("3 triangles turned")));
}

TEST(SurfaceCleaning, SurvivesASurfaceOfNothingButNoise) {
  SurfaceMesh mesh;
  mesh.points = Eigen::Matrix3Xd::Constant(3, 9, 0.01);
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_TRUE(clean_surface(mesh).mesh.triangles.empty());
}

}  // namespace
}  // namespace lipofill::geometry
