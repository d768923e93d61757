#include "core/geometry/ray_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lipofill::geometry {
namespace {

constexpr int kMaxDepth = 64;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

/// A binary tree, split at the median of the longest side down to leaves of four triangles, of
/// which every other level is then left out.
struct RayTree::Builder {
  struct Box {
    Eigen::Vector3d low;
    Eigen::Vector3d high;
    int first = 0;   ///< the triangles of a leaf begin here
    int count = 0;   ///< 0: not a leaf
    int second = 0;  ///< the other child; the one child follows its parent
  };

  explicit Builder(const SurfaceMesh& the_mesh) : mesh(the_mesh), order(the_mesh.triangles.size()) {
    std::iota(order.begin(), order.end(), 0);
    centres.resize(3, mesh.n_triangles());
    for (int t = 0; t < mesh.n_triangles(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      centres.col(t) = (mesh.points.col(a) + mesh.points.col(b) + mesh.points.col(c)) / 3.0;
    }
    if (!order.empty()) split(0, mesh.n_triangles());
  }

  void split(int begin, int end) {
    const size_t here = boxes.size();
    boxes.push_back(bound(begin, end));
    if (end - begin <= kLanes) {
      boxes[here].first = begin;
      boxes[here].count = end - begin;
      return;
    }
    Eigen::Index axis = 0;
    (boxes[here].high - boxes[here].low).maxCoeff(&axis);
    const int middle = (begin + end) / 2;
    std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                     [&](int a, int b) { return std::pair(centres(axis, a), a) < std::pair(centres(axis, b), b); });
    split(begin, middle);
    boxes[here].second = static_cast<int>(boxes.size());
    split(middle, end);
  }

  Box bound(int begin, int end) const {
    Box box;
    box.low.setConstant(kInfinity);
    box.high = -box.low;
    for (int k = begin; k < end; ++k) {
      const auto& triangle = mesh.triangles[order[k]];
      const Eigen::Vector3d corner = mesh.points.col(triangle[0]);
      const Eigen::Vector3d edge1 = mesh.points.col(triangle[1]) - corner;
      const Eigen::Vector3d edge2 = mesh.points.col(triangle[2]) - corner;
      // The points that a ray is tried against: rounding apart those of the mesh.
      for (const Eigen::Vector3d& p : {corner, Eigen::Vector3d(corner + edge1), Eigen::Vector3d(corner + edge2)}) {
        box.low = box.low.cwiseMin(p);
        box.high = box.high.cwiseMax(p);
      }
    }
    return box;
  }

  /// The boxes under a box in their order, two levels down where there are so many.
  std::vector<int> boxes_under(int box) const {
    std::vector<int> under;
    if (boxes[box].count > 0) return {box};  // a tree of one leaf
    for (const int child : {box + 1, boxes[box].second}) {
      if (boxes[child].count > 0) {
        under.push_back(child);
      } else {
        under.insert(under.end(), {child + 1, boxes[child].second});
      }
    }
    return under;
  }

  /// Brings the boxes under a box into the tree; returns their node.
  int take_over(int box, RayTree& tree) const {
    const int here = static_cast<int>(tree.nodes_.size());
    tree.nodes_.emplace_back();
    const std::vector<int> under = boxes_under(box);
    tree.nodes_[here].count = static_cast<int>(under.size());
    for (size_t lane = 0; lane < under.size(); ++lane) {
      const Box& lower = boxes[under[lane]];
      for (int c = 0; c < 3; ++c) {
        tree.nodes_[here].low[c][lane] = lower.low[c];
        tree.nodes_[here].high[c][lane] = lower.high[c];
      }
      const int child = lower.count > 0 ? ~take_over_leaf(lower, tree) : take_over(under[lane], tree);
      tree.nodes_[here].child[lane] = child;
    }
    return here;
  }

  int take_over_leaf(const Box& box, RayTree& tree) const {
    Leaf& leaf = tree.leaves_.emplace_back();
    for (int lane = 0; lane < box.count; ++lane) {
      const auto& [a, b, c] = mesh.triangles[order[box.first + lane]];
      for (int k = 0; k < 3; ++k) {
        leaf.corner[k][lane] = mesh.points(k, a);
        leaf.edge1[k][lane] = mesh.points(k, b) - mesh.points(k, a);
        leaf.edge2[k][lane] = mesh.points(k, c) - mesh.points(k, a);
      }
    }
    return static_cast<int>(tree.leaves_.size()) - 1;
  }

  const SurfaceMesh& mesh;
  Eigen::Matrix3Xd centres;
  std::vector<int> order;
  std::vector<Box> boxes;
};

RayTree::RayTree(const SurfaceMesh& mesh) {
  const Builder builder(mesh);
  if (!builder.boxes.empty()) builder.take_over(0, *this);
}

/// A ray, the same in every lane.
struct RayTree::Ray {
  Ray(const Eigen::Vector3d& the_from, const Eigen::Vector3d& the_direction) {
    for (int c = 0; c < 3; ++c) {
      from[c] = fill_lanes(the_from[c]);
      direction[c] = fill_lanes(the_direction[c]);
      inverse[c] = 1.0 / direction[c];
      is_negative[c] = std::signbit(the_direction[c]);
    }
  }

  /// Distance at which the ray enters each box; infinity when it does not meet the box within
  /// `reach`. A ray within a slab's plane multiplies 0 by infinity: comparisons with the
  /// not-a-number that gives are false, and the slab is passed over.
  Lanes enter(const Node& node, double reach) const {
    Lanes enter{};
    Lanes leave = fill_lanes(reach);
    for (int c = 0; c < 3; ++c) {
      const Lanes near = ((is_negative[c] ? node.high[c] : node.low[c]) - from[c]) * inverse[c];
      const Lanes far = ((is_negative[c] ? node.low[c] : node.high[c]) - from[c]) * inverse[c];
      enter = near > enter ? near : enter;
      leave = far < leave ? far : leave;
    }
    return enter <= leave ? enter : fill_lanes(kInfinity);
  }

  LanesXyz from;
  LanesXyz direction;
  LanesXyz inverse;
  std::array<bool, 3> is_negative{};
};

namespace {

// These use no fused products, so that the triangles a ray meets at their edges stay as they always
// were.
template <typename Xyz>
auto dot(const Xyz& a, const Xyz& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <typename Xyz>
Xyz cross(const Xyz& a, const Xyz& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

/// Moeller & Trumbore (1997), for both sides of the triangles.
Lanes RayTree::meet(const Leaf& leaf, const Ray& ray) {
  const LanesXyz p = cross(ray.direction, leaf.edge2);
  const Lanes determinant = dot(leaf.edge1, p);
  const LanesXyz gap = {ray.from[0] - leaf.corner[0], ray.from[1] - leaf.corner[1], ray.from[2] - leaf.corner[2]};
  const Lanes u = dot(gap, p) / determinant;
  const LanesXyz q = cross(gap, leaf.edge1);
  const Lanes v = dot(ray.direction, q) / determinant;
  const Lanes distance = dot(leaf.edge2, q) / determinant;
  const auto met = (determinant != 0.0) & (u >= 0.0) & (u <= 1.0) & (v >= 0.0) & (u + v <= 1.0) & (distance > 0.0);
  return met ? distance : fill_lanes(kInfinity);
}

template <typename Reach, typename Visit>
void RayTree::walk(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, const Reach& reach,
                   const Visit& visit) const {
  if (nodes_.empty()) return;
  const Ray ray(from, direction);
  struct Waiting {
    int child;
    double enter;
  };
  std::array<Waiting, kMaxDepth * kLanes> waiting;
  waiting[0] = {0, 0.0};
  for (int n_waiting = 1; n_waiting > 0;) {
    const Waiting at = waiting[--n_waiting];
    if (!(at.enter <= reach())) continue;
    if (at.child < 0) {
      if (!visit(meet(leaves_[~at.child], ray))) return;
      continue;
    }
    const Node& node = nodes_[at.child];
    const Lanes enter = ray.enter(node, reach());
    for (int lane = node.count - 1; lane >= 0; --lane) {
      if (enter[lane] < kInfinity) waiting[n_waiting++] = {node.child[lane], enter[lane]};
    }
  }
}

bool RayTree::is_blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
  bool blocked = false;
  walk(
      from, direction, [] { return kInfinity; },
      [&](const Lanes& distance) {
        blocked = any(distance < kInfinity);
        return !blocked;
      });
  return blocked;
}

double RayTree::find_first(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double reach) const {
  double first = kInfinity;
  walk(
      from, direction, [&] { return std::min(first, reach); },
      [&](const Lanes& distance) {
        for (int lane = 0; lane < kLanes; ++lane) first = std::min(first, distance[lane]);
        return true;
      });
  return first <= reach ? first : kInfinity;
}

}  // namespace lipofill::geometry
