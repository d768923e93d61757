#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace lipofill::geometry {

/// This tells how a polygon could be cut into triangles.
enum class PolygonCut {
  kFan,       ///< from its first corner
  kEars,      ///< ear by ear: it is not convex
  kCrossing,  ///< it crosses itself, so that some triangles lie outside it
};

/// Cuts a polygon into n - 2 triangles that lie inside it, of its own direction. The fan from the
/// first corner is kept where it does (all its triangles have area and face the way of the
/// polygon); elsewhere ears are cut off: corners whose triangle has area, lies inside and holds no
/// other corner (Meisters 1975, doi:10.1080/00029890.1975.11993898). The polygon may be bent a
/// little, have corners in line, and run twice along a cut to a hole in it. n^2 operations.
/// @param corners    out of range is undefined; at least 3
/// @param points     (3, n), finite where `corners` point to
/// @param triangles  out: n - 2, overwritten
/// Checked by tests/unit/geometry/polygon_triangulation_test.cc.
PolygonCut triangulate_polygon(std::span<const int> corners, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                               std::vector<std::array<int, 3>>& triangles);

}  // namespace lipofill::geometry
