#include "core/planning/skin_surface.h"

#include <gtest/gtest.h>

#include "tests/unit/planning/test_heads.h"

namespace lipofill::planning {
namespace {

geometry::SurfaceMesh join(geometry::SurfaceMesh a, const geometry::SurfaceMesh& b) {
  const int first = a.n_vertices();
  const Eigen::Index n = a.points.cols();
  a.points.conservativeResize(3, n + b.points.cols());
  a.points.rightCols(b.points.cols()) = b.points;
  for (const auto& t : b.triangles) a.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return a;
}

TEST(SkinSurface, LeavesOutWhatLiesInside) {
  const geometry::SurfaceMesh head = make_even_head();
  geometry::SurfaceMesh inner = make_even_head();
  inner.points *= 0.8;
  const auto skin = extract_skin(join(head, inner), "the head");
  ASSERT_TRUE(skin.ok()) << skin.status();
  EXPECT_EQ(skin->mesh.n_triangles(), head.n_triangles());
  EXPECT_EQ(skin->rim.cols(), 0) << "a closed head has no rim";
  for (int v = 0; v < skin->mesh.n_vertices(); ++v) {
    EXPECT_EQ(skin->mesh.points.col(v), head.points.col(skin->scan_vertex[v]));
  }
}

TEST(SkinSurface, TurnsASurfaceThatIsInsideOut) {
  geometry::SurfaceMesh head = make_even_head();
  for (auto& t : head.triangles) std::swap(t[1], t[2]);
  const auto skin = extract_skin(head, "the head");
  ASSERT_TRUE(skin.ok());
  EXPECT_TRUE(skin->was_inside_out);
  EXPECT_GT(skin->normals.col(0).dot(skin->mesh.points.col(0)), 0.0);
}

TEST(SkinSurface, FindsTheRimAndNoSmallHoles) {
  geometry::SurfaceMesh mask = cut_away(make_even_head(), {0, 0, -1}, 0.5);
  mask.triangles.erase(mask.triangles.begin() + mask.n_triangles() / 2);
  const auto skin = extract_skin(mask, "the mask");
  ASSERT_TRUE(skin.ok());
  ASSERT_GT(skin->rim.cols(), 50);
  const double middle = skin->rim.row(2).mean();
  EXPECT_LT((skin->rim.row(2).array() - middle).abs().maxCoeff(), 0.01) << "the rim lies where the mask was cut";
}

TEST(SkinSurface, RefusesWhatIsNone) {
  EXPECT_FALSE(extract_skin({}, "the scan").ok());
}

}  // namespace
}  // namespace lipofill::planning
