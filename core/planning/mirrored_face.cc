#include "core/planning/mirrored_face.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace lipofill::planning {
namespace {

constexpr double kOnPlane = 1e-7;  // [m]; a vertex this near lies on the plane

/// Cuts a surface at a plane and keeps what is above it. Vertices on the plane have height 0.
class HalfCutter {
 public:
  HalfCutter(const geometry::SurfaceMesh& whole, const Reflection& plane, double sign) : whole_(whole) {
    for (int v = 0; v < whole.n_vertices(); ++v) {
      const double height = sign * plane.height(whole.points.col(v));
      heights_.push_back(std::abs(height) < kOnPlane ? 0.0 : height);
    }
    new_vertex_.assign(heights_.size(), -1);
    for (const auto& triangle : whole.triangles) cut(triangle);
  }

  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  const std::vector<bool>& on_plane() const { return on_plane_; }
  const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }

 private:
  int add_point(const Eigen::Vector3d& point, bool on_plane) {
    points_.push_back(point);
    on_plane_.push_back(on_plane);
    return static_cast<int>(points_.size()) - 1;
  }
  int keep_vertex(int v) {
    if (new_vertex_[v] < 0) new_vertex_[v] = add_point(whole_.points.col(v), heights_[v] == 0.0);
    return new_vertex_[v];
  }
  int cut_edge(int a, int b) {
    const auto edge = std::minmax(a, b);
    const auto [found, is_new] = edge_point_.try_emplace(edge, -1);
    if (is_new) {
      const double share = heights_[edge.first] / (heights_[edge.first] - heights_[edge.second]);
      found->second =
          add_point((1.0 - share) * whole_.points.col(edge.first) + share * whole_.points.col(edge.second), true);
    }
    return found->second;
  }
  /// The part of a triangle above the plane is a polygon of up to four corners.
  void cut(const std::array<int, 3>& triangle) {
    if (std::none_of(triangle.begin(), triangle.end(), [&](int v) { return heights_[v] > 0.0; })) return;
    std::vector<int> polygon;
    for (int k = 0; k < 3; ++k) {
      const int a = triangle[k], b = triangle[(k + 1) % 3];
      if (heights_[a] >= 0.0) polygon.push_back(keep_vertex(a));
      if (heights_[a] * heights_[b] < 0.0) polygon.push_back(cut_edge(a, b));
    }
    for (size_t k = 1; k + 1 < polygon.size(); ++k) triangles_.push_back({polygon[0], polygon[k], polygon[k + 1]});
  }

  const geometry::SurfaceMesh& whole_;
  std::vector<double> heights_;
  std::vector<int> new_vertex_;
  std::map<std::pair<int, int>, int> edge_point_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<bool> on_plane_;
  std::vector<std::array<int, 3>> triangles_;
};

}  // namespace

geometry::SurfaceMesh make_mirrored_face(const geometry::SurfaceMesh& skin, const Reflection& plane, FaceSide healthy) {
  const HalfCutter half(skin, plane, healthy == FaceSide::kLeft ? 1.0 : -1.0);
  std::vector<Eigen::Vector3d> points = half.points();
  std::vector<int> image;
  for (size_t v = 0; v < half.points().size(); ++v) {
    image.push_back(half.on_plane()[v] ? static_cast<int>(v) : static_cast<int>(points.size()));
    if (!half.on_plane()[v]) points.push_back(plane.apply(half.points()[v]));
  }
  geometry::SurfaceMesh face;
  face.triangles = half.triangles();
  for (const auto& t : half.triangles()) face.triangles.push_back({image[t[0]], image[t[2]], image[t[1]]});
  face.points.resize(3, static_cast<Eigen::Index>(points.size()));
  for (size_t v = 0; v < points.size(); ++v) face.points.col(static_cast<Eigen::Index>(v)) = points[v];
  return face;
}

}  // namespace lipofill::planning
