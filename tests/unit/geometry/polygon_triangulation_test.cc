#include "core/geometry/polygon_triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>
#include <random>

namespace lipofill::geometry {
namespace {

using Points = Eigen::Matrix3Xd;

Points in_plane(std::initializer_list<std::array<double, 2>> corners) {
  Points points(3, static_cast<Eigen::Index>(corners.size()));
  Eigen::Index k = 0;
  for (const auto& [x, y] : corners) points.col(k++) = Eigen::Vector3d(x, y, 0.0);
  return points;
}

/// A polygon around the origin whose radius jumps up and down.
Points make_star(int n, std::mt19937& random) {
  std::uniform_real_distribution<double> radius(0.2, 1.0);
  Points points(3, n);
  for (int k = 0; k < n; ++k) {
    const double angle = 2.0 * M_PI * k / n;
    points.col(k) = radius(random) * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
  }
  return points;
}

Eigen::Vector3d newell_normal(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    sum += (points.col(k) - points.col(0)).cross(points.col((k + 1) % points.cols()) - points.col(0));
  }
  return sum;
}

struct Cut {
  PolygonCut how;
  std::vector<std::array<int, 3>> triangles;
};

Cut cut(const Points& points) {
  std::vector<int> corners(static_cast<size_t>(points.cols()));
  std::iota(corners.begin(), corners.end(), 0);
  Cut result;
  result.how = triangulate_polygon(corners, points, result.triangles);
  return result;
}

/// Triangles that all face the way of a simple polygon and have its area together lie inside it.
void expect_inside(const Points& points, const Cut& result) {
  ASSERT_EQ(result.triangles.size(), static_cast<size_t>(points.cols()) - 2);
  const Eigen::Vector3d normal = newell_normal(points);
  double area = 0.0;
  for (const auto& [a, b, c] : result.triangles) {
    const Eigen::Vector3d twice = (points.col(b) - points.col(a)).cross(points.col(c) - points.col(a));
    EXPECT_GE(twice.dot(normal), -1e-9 * normal.squaredNorm());
    area += twice.norm();
  }
  EXPECT_NEAR(area / normal.norm(), 1.0, 1e-7);
}

TEST(PolygonTriangulation, KeepsTheFanOfAConvexPolygon) {
  const Cut result = cut(in_plane({{0, 0}, {50, 0}, {60, 40}, {25, 70}, {-10, 40}}));
  EXPECT_EQ(result.how, PolygonCut::kFan);
  EXPECT_EQ(result.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

TEST(PolygonTriangulation, StaysInsidePolygonsThatAreNotConvex) {
  // The L of a wall, once from each corner; an arrow; a comb; a frame that is open at a seam.
  Points wall = in_plane({{200, 100}, {100, 100}, {100, 200}, {0, 200}, {0, 0}, {200, 0}});
  for (int turn = 0; turn < 6; ++turn) {
    expect_inside(wall, cut(wall));
    const Points old = wall;
    for (int k = 0; k < 6; ++k) wall.col(k) = old.col((k + 1) % 6);
  }
  const Points arrow = in_plane({{0, 0}, {10, -10}, {0, 30}, {-10, -10}});
  EXPECT_EQ(cut(arrow).how, PolygonCut::kFan);
  Points turned_arrow(3, 4);
  for (int k = 0; k < 4; ++k) turned_arrow.col(k) = arrow.col((k + 1) % 4);
  EXPECT_EQ(cut(turned_arrow).how, PolygonCut::kEars);
  expect_inside(turned_arrow, cut(turned_arrow));
  Points comb(3, 83);
  for (int k = 0; k < 81; ++k) comb.col(k) = Eigen::Vector3d(80 - k, k % 2 == 0 ? 1 : 10, 0);
  comb.col(81) = Eigen::Vector3d(0, 0, 0);
  comb.col(82) = Eigen::Vector3d(80, 0, 0);
  expect_inside(comb, cut(comb));
  const Points frame = in_plane({{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}});
  expect_inside(frame, cut(frame));
}

TEST(PolygonTriangulation, LeavesNoCornerInLineWithoutTriangleWhereItNeedNot) {
  const Points square = in_plane({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {0, 2}});
  const Cut result = cut(square);
  expect_inside(square, result);
  for (const auto& [a, b, c] : result.triangles) {
    EXPECT_GT((square.col(b) - square.col(a)).cross(square.col(c) - square.col(a)).norm(), 0.5);
  }
}

TEST(PolygonTriangulation, IsAsGoodTiltedAndFarFromTheOrigin) {
  std::mt19937 random(20);
  const Eigen::Matrix3d tilt = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized().toRotationMatrix();
  for (const int n : {5, 8, 20, 101}) {
    for (int round = 0; round < 40; ++round) {
      Points star = make_star(n, random);
      expect_inside(star, cut(star));
      star = (tilt * star).colwise() + Eigen::Vector3d(5e5, -4e5, 3e5);
      expect_inside(star, cut(star));
    }
  }
}

TEST(PolygonTriangulation, SaysThatAPolygonCrossesItself) {
  const Cut bow = cut(in_plane({{0, 0}, {3, 2}, {3, 0}, {0, 1}}));
  EXPECT_EQ(bow.how, PolygonCut::kCrossing);
  EXPECT_EQ(bow.triangles.size(), 2u);
  const Cut point = cut(Points::Constant(3, 6, 0.25));
  EXPECT_EQ(point.triangles.size(), 4u);
}

}  // namespace
}  // namespace lipofill::geometry
