#include "core/planning/mirrored_face.h"

#include <gtest/gtest.h>

#include "tests/unit/planning/test_heads.h"

namespace lipofill::planning {
namespace {

double compute_volume(const geometry::SurfaceMesh& mesh) {
  double volume = 0.0;
  for (const auto& t : mesh.triangles) {
    volume += mesh.points.col(t[0]).cross(mesh.points.col(t[1])).dot(mesh.points.col(t[2])) / 6.0;
  }
  return volume;
}

bool is_closed(const geometry::SurfaceMesh& mesh) {
  for (const auto& across : geometry::find_neighbours(mesh).across) {
    if (across[0] < 0 || across[1] < 0 || across[2] < 0) return false;
  }
  return true;
}

TEST(MirroredFace, OfAnEvenHeadIsThatHead) {
  const geometry::SurfaceMesh head = make_even_head();
  for (const FaceSide side : {FaceSide::kLeft, FaceSide::kRight}) {
    const geometry::SurfaceMesh mirrored = make_mirrored_face(head, {}, side);
    EXPECT_TRUE(is_closed(mirrored));
    EXPECT_NEAR(compute_volume(mirrored) / compute_volume(head), 1.0, 1e-4);
  }
}

// The plane cuts through triangles, and the two halves of an uneven head make up for each other.
TEST(MirroredFace, IsClosedWhereThePlaneCutsTriangles) {
  const geometry::SurfaceMesh head = make_uneven_head();
  const Reflection plane{Eigen::Vector3d(1.0, 0.03, -0.02).normalized(), 0.0013};
  const geometry::SurfaceMesh left = make_mirrored_face(head, plane, FaceSide::kLeft);
  const geometry::SurfaceMesh right = make_mirrored_face(head, plane, FaceSide::kRight);
  EXPECT_TRUE(is_closed(left));
  EXPECT_TRUE(is_closed(right));
  EXPECT_NEAR((compute_volume(left) + compute_volume(right)) / (2.0 * compute_volume(head)), 1.0, 1e-6);
  EXPECT_GT(std::abs(compute_volume(left) - compute_volume(right)), 1e-6);
  EXPECT_NEAR(compute_volume(reflect(left, plane)), compute_volume(left), 1e-12);
}

}  // namespace
}  // namespace lipofill::planning
