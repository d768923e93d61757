#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// A surface of n x m quadrilaterals, each cut in two, over parameters u, v in [0, 1]; u x v points
/// outwards.
inline SurfaceMesh make_sheet(int n, int m, const std::function<Eigen::Vector3d(double, double)>& position) {
  SurfaceMesh mesh;
  mesh.points.resize(3, (n + 1) * (m + 1));
  for (int j = 0; j <= m; ++j) {
    for (int i = 0; i <= n; ++i) {
      mesh.points.col(j * (n + 1) + i) = position(static_cast<double>(i) / n, static_cast<double>(j) / m);
      if (i == n || j == m) continue;
      const int a = j * (n + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  }
  return mesh;
}

/// A piece of a sphere about the origin, around +x: longitude and latitude in [-width / 2,
/// width / 2].
inline SurfaceMesh make_sphere_cap(double radius, double width, int n) {
  return make_sheet(n, n, [=](double u, double v) {
    const double longitude = (u - 0.5) * width;
    const double latitude = (v - 0.5) * width;
    return Eigen::Vector3d(radius * std::cos(latitude) * std::cos(longitude),
                           radius * std::cos(latitude) * std::sin(longitude), radius * std::sin(latitude));
  });
}

/// A whole sphere about the origin, from a cube of n x n facets a side.
inline SurfaceMesh make_sphere(double radius, int n) {
  SurfaceMesh sphere;
  std::vector<Eigen::Vector3d> points;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const SurfaceMesh sheet = make_sheet(n, n, [&](double u, double v) {
        Eigen::Vector3d p;
        p[axis] = side;
        p[(axis + 1) % 3] = side * std::tan((u - 0.5) * M_PI / 2);
        p[(axis + 2) % 3] = std::tan((v - 0.5) * M_PI / 2);
        return Eigen::Vector3d(radius * p.normalized());
      });
      const int first = static_cast<int>(points.size());
      for (int v = 0; v < sheet.n_vertices(); ++v) points.emplace_back(sheet.points.col(v));
      for (const auto& [a, b, c] : sheet.triangles) sphere.triangles.push_back({first + a, first + b, first + c});
    }
  }
  sphere.points.resize(3, static_cast<Eigen::Index>(points.size()));
  for (size_t v = 0; v < points.size(); ++v) sphere.points.col(static_cast<Eigen::Index>(v)) = points[v];
  return sphere;
}

/// Two surfaces as one, their parts not joined.
inline SurfaceMesh put_together(const SurfaceMesh& a, const SurfaceMesh& b) {
  SurfaceMesh both;
  both.points.resize(3, a.points.cols() + b.points.cols());
  both.points << a.points, b.points;
  both.triangles = a.triangles;
  for (const auto& [p, q, r] : b.triangles) {
    both.triangles.push_back({p + a.n_vertices(), q + a.n_vertices(), r + a.n_vertices()});
  }
  return both;
}

/// The same surface turned inside out.
inline SurfaceMesh turn_over(SurfaceMesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

}  // namespace lipofill::geometry
