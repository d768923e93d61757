#pragma once

// Heads made of formulas, for tests whose answers are known.

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/geometry/head_axes.h"
#include "core/geometry/surface_mesh.h"
#include "core/geometry/surface_topology.h"
#include "core/planning/reflection.h"
#include "core/planning/rigid_motion.h"

namespace lipofill::planning {

/// A bump on a head: its direction from the middle, how wide it is [rad], and how high [m].
struct Bump {
  Eigen::Vector3d direction;
  double width;
  double height;
};

/// Bumps at the same places of both sides of a face: nose, chin, brows, cheekbones, ears.
inline std::vector<Bump> symmetric_bumps() {
  std::vector<Bump> bumps = {
      {{0, -0.05, 1}, 0.16, 0.022}, {{0, -0.75, 0.8}, 0.25, 0.012}, {{0, 0.8, -0.6}, 0.5, 0.006}};
  for (const double side : {-1.0, 1.0}) {
    bumps.push_back({{side * 0.35, 0.35, 0.9}, 0.2, 0.006});
    bumps.push_back({{side * 0.6, -0.1, 0.75}, 0.25, 0.007});
    bumps.push_back({{side, 0.0, -0.1}, 0.15, 0.020});
  }
  return bumps;
}

/// An ellipsoid (+x left, +y up, +z forward) with bumps, closed, n rings of 2n points.
inline geometry::SurfaceMesh make_head(const std::vector<Bump>& bumps, int n = 60) {
  const auto place = [&](double polar, double around) -> Eigen::Vector3d {
    const Eigen::Vector3d u(std::sin(polar) * std::sin(around), std::cos(polar), std::sin(polar) * std::cos(around));
    double radius = 1.0 / std::sqrt(std::pow(u[0] / 0.075, 2) + std::pow(u[1] / 0.110, 2) + std::pow(u[2] / 0.095, 2));
    for (const Bump& bump : bumps) {
      const double angle = std::acos(std::clamp(u.dot(bump.direction.normalized()), -1.0, 1.0)) / bump.width;
      radius += bump.height * std::exp(-angle * angle);
    }
    return radius * u;
  };
  geometry::SurfaceMesh head;
  const int around = 2 * n;
  head.points.resize(3, 2 + (n - 1) * around);
  head.points.col(0) = place(0.0, 0.0);
  head.points.col(1) = place(std::numbers::pi, 0.0);
  const auto index = [&](int ring, int k) { return 2 + (ring - 1) * around + k % around; };
  for (int ring = 1; ring < n; ++ring) {
    for (int k = 0; k < around; ++k) {
      head.points.col(index(ring, k)) = place(std::numbers::pi * ring / n, std::numbers::pi * k / n);
    }
  }
  for (int k = 0; k < around; ++k) {
    head.triangles.push_back({0, index(1, k), index(1, k + 1)});
    head.triangles.push_back({1, index(n - 1, k + 1), index(n - 1, k)});
    for (int ring = 1; ring + 1 < n; ++ring) {
      head.triangles.push_back({index(ring, k), index(ring + 1, k), index(ring + 1, k + 1)});
      head.triangles.push_back({index(ring, k), index(ring + 1, k + 1), index(ring, k + 1)});
    }
  }
  return head;
}

/// A head whose sides differ: one bump on the left cheek, another on the right of the forehead.
inline geometry::SurfaceMesh make_uneven_head() {
  std::vector<Bump> bumps = symmetric_bumps();
  bumps.push_back({{0.7, -0.45, 0.5}, 0.3, 0.008});
  bumps.push_back({{-0.5, 0.6, 0.6}, 0.3, 0.006});
  return make_head(bumps);
}

inline geometry::SurfaceMesh make_even_head() {
  return make_head(symmetric_bumps());
}

/// A point of the skin in a direction from the middle.
inline Eigen::Vector3d find_farthest_along(const geometry::SurfaceMesh& head, const Eigen::Vector3d& direction) {
  int best = 0;
  double most = -1.0;
  for (int v = 0; v < head.n_vertices(); ++v) {
    const double cosine = head.points.col(v).dot(direction) / head.points.col(v).norm();
    if (cosine > most) most = cosine, best = v;
  }
  return head.points.col(best);
}

inline geometry::Landmarks make_landmarks(const geometry::SurfaceMesh& head) {
  geometry::Landmarks landmarks;
  landmarks["nasion"] = find_farthest_along(head, {0, 0.25, 1});
  landmarks["pronasale"] = find_farthest_along(head, {0, -0.05, 1});
  landmarks["subnasale"] = find_farthest_along(head, {0, -0.25, 1});
  landmarks["pogonion"] = find_farthest_along(head, {0, -0.75, 0.8});
  landmarks["menton"] = find_farthest_along(head, {0, -0.95, 0.7});
  for (const auto& [side, sign] : {std::pair{"_left", 1.0}, std::pair{"_right", -1.0}}) {
    const auto put = [&](const char* name, double x, double y, double z) {
      landmarks[std::string(name) + side] = find_farthest_along(head, {sign * x, y, z});
    };
    put("exocanthion", 0.5, 0.3, 0.8);
    put("cheilion", 0.3, -0.4, 0.95);
    put("zygion", 0.9, 0.05, 0.35);
    put("gonion", 0.7, -0.65, 0.2);
    put("tragion", 0.95, 0.0, 0.05);
  }
  return landmarks;
}

inline geometry::SurfaceMesh move_surface(geometry::SurfaceMesh mesh, const RigidMotion& motion) {
  for (int v = 0; v < mesh.n_vertices(); ++v) mesh.points.col(v) = motion.apply(mesh.points.col(v)).eval();
  return mesh;
}

inline RigidMotion make_pose() {
  return {Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix(),
          Eigen::Vector3d(0.12, -0.3, 0.05)};
}

/// The triangles on one side of a plane, so many of all.
inline geometry::SurfaceMesh cut_away(const geometry::SurfaceMesh& mesh, const Eigen::Vector3d& direction,
                                      double share) {
  std::vector<double> heights, sorted;
  for (const auto& t : mesh.triangles) {
    heights.push_back(direction.dot(mesh.points.col(t[0]) + mesh.points.col(t[1]) + mesh.points.col(t[2])));
  }
  sorted = heights;
  std::sort(sorted.begin(), sorted.end());
  const double bar = sorted[static_cast<size_t>((1.0 - share) * static_cast<double>(sorted.size()))];
  std::vector<int> kept;
  for (size_t t = 0; t < heights.size(); ++t) {
    if (heights[t] < bar) kept.push_back(static_cast<int>(t));
  }
  return geometry::extract_triangles(mesh, kept).mesh;
}

}  // namespace lipofill::planning
