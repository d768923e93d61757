#include "core/planning/symmetry_plane.h"

#include <gmock/gmock.h>

#include "core/base/units.h"
#include "core/planning/symmetry_index.h"
#include "tests/unit/planning/test_heads.h"

namespace lipofill::planning {
namespace {

/// Landmarks, each off by so much in a direction of its own.
geometry::Landmarks disturb(geometry::Landmarks landmarks, double by) {
  double k = 1.0;
  for (auto& [name, position] : landmarks) {
    position += by * Eigen::Vector3d(std::sin(3.0 * k), std::sin(5.0 * k + 1.0), std::sin(7.0 * k + 2.0));
    k += 1.0;
  }
  return landmarks;
}

double angle_to_left(const SymmetryPlane& plane) {
  return std::acos(std::min(1.0, plane.reflection.normal[0])) / kRadiansPerDegree;
}

TEST(SymmetryPlane, IsFoundFromPoorLandmarks) {
  const geometry::SurfaceMesh head = make_even_head();
  const auto plane = find_symmetry_plane(*extract_skin(head, "the head"), disturb(make_landmarks(head), 0.004));
  ASSERT_TRUE(plane.ok()) << plane.status();
  EXPECT_LT(angle_to_left(*plane), 0.01);
  EXPECT_LT(std::abs(plane->reflection.offset), 1e-5);
  EXPECT_GT(plane->turned + plane->moved, 1e-4) << "the landmarks were off";
  EXPECT_LT(plane->index, 1e-4) << "the triangles of the two sides are not quite mirror images";
}

// The left cheek has lost 8 mm over a region as large as a masseter.
TEST(SymmetryPlane, IsNotMovedByASickSide) {
  std::vector<Bump> bumps = symmetric_bumps();
  bumps.push_back({{0.75, -0.4, 0.45}, 0.35, -0.008});
  const geometry::SurfaceMesh head = make_head(bumps);
  const auto plane = find_symmetry_plane(*extract_skin(head, "the head"), disturb(make_landmarks(head), 0.003));
  ASSERT_TRUE(plane.ok()) << plane.status();
  EXPECT_LT(angle_to_left(*plane), 0.1);
  EXPECT_LT(std::abs(plane->reflection.offset), 1e-4);
  EXPECT_GT(plane->index, 1e-3);
}

TEST(SymmetryPlane, MovesWithTheHead) {
  const RigidMotion pose = make_pose();
  const geometry::SurfaceMesh head = make_even_head();
  geometry::Landmarks landmarks = disturb(make_landmarks(head), 0.003);
  for (auto& [name, position] : landmarks) position = pose.apply(position);
  const auto plane = find_symmetry_plane(*extract_skin(move_surface(head, pose), "the head"), landmarks);
  ASSERT_TRUE(plane.ok());
  EXPECT_LT((plane->reflection.normal - pose.rotation.col(0)).norm(), 2e-4);
}

TEST(SymmetryPlane, SaysThatItNeedsLandmarks) {
  const auto plane = find_symmetry_plane(*extract_skin(make_even_head(), "the head"), {});
  EXPECT_THAT(std::string(plane.status().message()), ::testing::HasSubstr("landmarks"));
}

// A plate 3 mm from the plane, whose face has its other side 5 mm from it: everywhere 2 mm apart.
TEST(SymmetryIndex, OfPlatesIsWhatTheirHeightsDifferBy) {
  const auto make_plate = [](double x, double size) {
    geometry::SurfaceMesh plate;
    plate.points.resize(3, 4);
    plate.points << x, x, x, x, -size, size, size, -size, -size, -size, size, size;
    plate.triangles = {{0, 1, 2}, {0, 2, 3}};
    if (x < 0.0) plate.triangles = {{0, 2, 1}, {0, 3, 2}};
    return plate;
  };
  SkinSurface face;
  face.mesh = make_plate(-0.005, 0.1);
  face.normals = geometry::compute_vertex_normals(face.mesh);
  face.is_border = {false, false};
  EXPECT_NEAR(measure_symmetry_index(make_plate(0.003, 0.02), face, {}), 0.002, 1e-12);
  EXPECT_EQ(measure_symmetry_index(make_plate(0.020, 0.02), face, {}), 0.0) << "15 mm apart are no counterparts";
}

}  // namespace
}  // namespace lipofill::planning
