#include "core/geometry/polygon_triangulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lipofill::geometry {
namespace {

constexpr double kNoArea = 1e-12;  // of the square of the polygon's size

/// A polygon in the plane that it lies in best, anticlockwise, around its first corner: far from
/// the origin its corners keep their digits.
class PlanePolygon {
 public:
  PlanePolygon(std::span<const int> corners, const Eigen::Ref<const Eigen::Matrix3Xd>& points) : places_(2, 0) {
    Eigen::Matrix3Xd around(3, static_cast<Eigen::Index>(corners.size()));
    for (Eigen::Index k = 0; k < around.cols(); ++k)
      around.col(k) = points.col(corners[static_cast<size_t>(k)]) - points.col(corners[0]);
    // Newell's normal: the sum of the areas that the sides sweep.
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < around.cols(); ++k) {
      normal += around.col(k).cross(around.col((k + 1) % around.cols()));
    }
    const double size = around.cwiseAbs().maxCoeff();
    no_area_ = kNoArea * size * size;
    has_area_ = normal.norm() > no_area_;
    for (Eigen::Index k = 2; k < around.cols(); ++k) {
      has_width_ = has_width_ || around.col(k - 1).cross(around.col(k)).norm() > no_area_;
    }
    if (!has_area_) return;
    const Eigen::Vector3d u = normal.unitOrthogonal();
    const Eigen::Vector3d v = normal.normalized().cross(u);
    places_.resize(2, around.cols());
    places_.row(0) = u.transpose() * around;
    places_.row(1) = v.transpose() * around;
  }

  bool has_area() const { return has_area_; }
  /// False where all corners are in line.
  bool has_width() const { return has_width_; }
  double no_area() const { return no_area_; }

  /// Twice the area of a triangle of corners; positive for one that faces the way of the polygon.
  double area(int a, int b, int c) const {
    const Eigen::Vector2d to_b = places_.col(b) - places_.col(a);
    const Eigen::Vector2d to_c = places_.col(c) - places_.col(a);
    return to_b.x() * to_c.y() - to_b.y() * to_c.x();
  }

  bool is_same_place(int a, int b) const { return places_.col(a) == places_.col(b); }

  /// True for a corner inside a triangle or on its sides, but not at one of its corners.
  bool is_within(int corner, int a, int b, int c) const {
    if (is_same_place(corner, a) || is_same_place(corner, b) || is_same_place(corner, c)) return false;
    return area(a, b, corner) >= 0.0 && area(b, c, corner) >= 0.0 && area(c, a, corner) >= 0.0;
  }

 private:
  Eigen::Matrix2Xd places_;
  double no_area_ = 0.0;
  bool has_area_ = false;
  bool has_width_ = false;
};

/// Cuts ears off a polygon whose corners are numbered from 0.
class EarCutter {
 public:
  EarCutter(const PlanePolygon& polygon, int n) : polygon_(polygon), left_(n) {
    for (int k = 0; k < n; ++k) {
      next_.push_back((k + 1) % n);
      previous_.push_back((k + n - 1) % n);
    }
    for (int k = 0; k < n; ++k) is_ear_.push_back(is_ear(k));
  }

  /// Adds n - 2 triangles; false where there came a moment without an ear, and none of no area.
  bool cut(std::vector<std::array<int, 3>>& triangles) {
    bool always_found = true;
    int at = 0;
    while (left_ > 3) {
      int corner = find_ear(at);
      if (corner < 0) corner = find_in_line(at);
      if (corner < 0) always_found = false, corner = at;
      at = remove(corner, triangles);
    }
    triangles.push_back({previous_[at], at, next_[at]});
    return always_found;
  }

 private:
  bool is_ear(int k) const {
    const int a = previous_[k];
    const int b = next_[k];
    if (polygon_.area(a, k, b) <= polygon_.no_area()) return false;
    for (int other = next_[b]; other != a; other = next_[other]) {
      if (polygon_.is_within(other, a, k, b)) return false;
    }
    return true;
  }

  int find_ear(int from) const {
    int k = from;
    for (int n = 0; n < left_; ++n, k = next_[k]) {
      if (is_ear_[static_cast<size_t>(k)]) return k;
    }
    return -1;
  }

  /// A corner in line with its neighbours, whose triangle has no area; -1 where there is none, as
  /// in a polygon that crosses itself.
  int find_in_line(int from) const {
    int k = from;
    for (int n = 0; n < left_; ++n, k = next_[k]) {
      if (std::abs(polygon_.area(previous_[k], k, next_[k])) <= polygon_.no_area()) return k;
    }
    return -1;
  }

  /// Cuts a corner off and returns where to look on: two corners further, so that triangles do not
  /// all share one.
  int remove(int k, std::vector<std::array<int, 3>>& triangles) {
    const int a = previous_[k];
    const int b = next_[k];
    triangles.push_back({a, k, b});
    next_[a] = b;
    previous_[b] = a;
    --left_;
    is_ear_[static_cast<size_t>(a)] = is_ear(a);
    is_ear_[static_cast<size_t>(b)] = is_ear(b);
    return next_[b];
  }

  const PlanePolygon& polygon_;
  int left_;
  std::vector<int> next_;
  std::vector<int> previous_;
  std::vector<bool> is_ear_;
};

}  // namespace

PolygonCut triangulate_polygon(std::span<const int> corners, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                               std::vector<std::array<int, 3>>& triangles) {
  const int n = static_cast<int>(corners.size());
  triangles.clear();
  for (int k = 2; k < n; ++k) triangles.push_back({0, k - 1, k});
  PolygonCut result = PolygonCut::kFan;
  const PlanePolygon polygon(corners, points);
  const auto faces_the_way = [&](const auto& t) { return polygon.area(t[0], t[1], t[2]) > polygon.no_area(); };
  if (n > 3 && !polygon.has_area()) {
    // Its two sides cancel out, unless it is a line.
    if (polygon.has_width()) result = PolygonCut::kCrossing;
  } else if (n > 3 && !std::all_of(triangles.begin(), triangles.end(), faces_the_way)) {
    triangles.clear();
    const bool always_found = EarCutter(polygon, n).cut(triangles);
    const bool is_turned = std::any_of(triangles.begin(), triangles.end(), [&](const auto& t) {
      return polygon.area(t[0], t[1], t[2]) < -polygon.no_area();
    });
    result = always_found && !is_turned ? PolygonCut::kEars : PolygonCut::kCrossing;
  }
  for (auto& triangle : triangles) {
    for (int& corner : triangle) corner = corners[static_cast<size_t>(corner)];
  }
  return result;
}

}  // namespace lipofill::geometry
