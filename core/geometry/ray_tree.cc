#include "core/geometry/ray_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lipofill::geometry {
namespace {

constexpr int kLargestLeaf = 4;
constexpr int kMaxDepth = 64;

}  // namespace

RayTree::RayTree(const SurfaceMesh& mesh) {
  const int n = mesh.n_triangles();
  Eigen::Matrix3Xd centres(3, n);
  for (int t = 0; t < n; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    centres.col(t) = (mesh.points.col(a) + mesh.points.col(b) + mesh.points.col(c)) / 3.0;
    triangles_.push_back(
        {mesh.points.col(a), mesh.points.col(b) - mesh.points.col(a), mesh.points.col(c) - mesh.points.col(a)});
  }
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  if (n > 0) build(order, 0, n, centres);
  std::vector<Triangle> sorted;
  sorted.reserve(triangles_.size());
  for (const int t : order) sorted.push_back(triangles_[t]);
  triangles_ = std::move(sorted);
}

void RayTree::build(std::vector<int>& order, int begin, int end, const Eigen::Matrix3Xd& centres) {
  Node node;
  node.low.setConstant(std::numeric_limits<double>::infinity());
  node.high = -node.low;
  for (int k = begin; k < end; ++k) {
    const Triangle& t = triangles_[order[k]];
    for (const Eigen::Vector3d& p :
         {t.corner, Eigen::Vector3d(t.corner + t.edge1), Eigen::Vector3d(t.corner + t.edge2)}) {
      node.low = node.low.cwiseMin(p);
      node.high = node.high.cwiseMax(p);
    }
  }
  const size_t here = nodes_.size();
  nodes_.push_back(node);
  if (end - begin <= kLargestLeaf) {
    nodes_[here].first = begin;
    nodes_[here].count = end - begin;
    return;
  }
  Eigen::Index axis = 0;
  (node.high - node.low).maxCoeff(&axis);
  const int middle = (begin + end) / 2;
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                   [&](int a, int b) { return std::pair(centres(axis, a), a) < std::pair(centres(axis, b), b); });
  build(order, begin, middle, centres);
  nodes_[here].second = static_cast<int>(nodes_.size());
  build(order, middle, end, centres);
}

namespace {

/// Slab test. A ray within a slab's plane divides 0 by 0: fmin and fmax pass over the not-a-number that gives.
bool meets_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Eigen::Vector3d& from,
               const Eigen::Vector3d& inverse, double reach) {
  double enter = 0.0;
  double leave = reach;
  for (int c = 0; c < 3; ++c) {
    const double a = (low[c] - from[c]) * inverse[c];
    const double b = (high[c] - from[c]) * inverse[c];
    enter = std::fmax(enter, std::fmin(a, b));
    leave = std::fmin(leave, std::fmax(a, b));
  }
  return enter <= leave;
}

/// Moeller & Trumbore (1997), for both sides of the triangle: the distance along the ray, infinity for a miss.
double meet_triangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& edge1, const Eigen::Vector3d& edge2,
                     const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  constexpr double kMiss = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d p = direction.cross(edge2);
  const double determinant = edge1.dot(p);
  if (determinant == 0.0) return kMiss;
  const Eigen::Vector3d gap = from - corner;
  const double u = gap.dot(p) / determinant;
  if (u < 0.0 || u > 1.0) return kMiss;
  const Eigen::Vector3d q = gap.cross(edge1);
  const double v = direction.dot(q) / determinant;
  if (!(v >= 0.0 && u + v <= 1.0)) return kMiss;
  const double distance = edge2.dot(q) / determinant;
  return distance > 0.0 ? distance : kMiss;
}

}  // namespace

template <typename Reach, typename Visit>
void RayTree::walk(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, const Reach& reach,
                   const Visit& visit) const {
  if (nodes_.empty()) return;
  const Eigen::Vector3d inverse = direction.cwiseInverse();
  std::array<int, kMaxDepth> waiting{};
  int n_waiting = 1;
  while (n_waiting > 0) {
    const int at = waiting[--n_waiting];
    const Node& node = nodes_[at];
    if (!meets_box(node.low, node.high, from, inverse, reach())) continue;
    if (node.count == 0) {
      waiting[n_waiting++] = node.second;
      waiting[n_waiting++] = at + 1;
      continue;
    }
    for (int k = node.first; k < node.first + node.count; ++k) {
      if (!visit(triangles_[k])) return;
    }
  }
}

bool RayTree::is_blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
  bool blocked = false;
  walk(
      from, direction, [] { return std::numeric_limits<double>::infinity(); },
      [&](const Triangle& t) {
        blocked = std::isfinite(meet_triangle(t.corner, t.edge1, t.edge2, from, direction));
        return !blocked;
      });
  return blocked;
}

double RayTree::find_first(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double reach) const {
  double first = std::numeric_limits<double>::infinity();
  walk(
      from, direction, [&] { return std::min(first, reach); },
      [&](const Triangle& t) {
        first = std::min(first, meet_triangle(t.corner, t.edge1, t.edge2, from, direction));
        return true;
      });
  return first <= reach ? first : std::numeric_limits<double>::infinity();
}

}  // namespace lipofill::geometry
