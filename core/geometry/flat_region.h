#pragma once

#include <Eigen/Core>
#include <array>

#include "absl/status/statusor.h"
#include "core/geometry/surface_chart.h"
#include "core/geometry/surface_locator.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// Corners in the plane, anticlockwise: (xi, eta) = (0, 0), (1, 0), (1, 1), (0, 1).
using Quadrilateral = std::array<Eigen::Vector2d, 4>;

/// A flattened patch of skin, and the part of the plane that is charted.
struct FlatRegion {
  Eigen::Matrix2Xd flat;  ///< (2, n_vertices)
  Quadrilateral quad;
};

/// The place of a point of the surface in the plane.
Eigen::Vector2d place_in_plane(const SurfaceMesh& mesh, const Eigen::Matrix2Xd& flat, const SurfacePoint& point);

bool contains(const Quadrilateral& quad, const Eigen::Vector2d& p);

/// The first triangle with a corner in the quadrilateral that the map turns over; -1 when there is
/// none. Slivers turn over without harm.
int find_fold(const SurfaceMesh& mesh, const Eigen::Matrix2Xd& flat, const Quadrilateral& quad);

/// FAILED_PRECONDITION that says where a triangle is turned over.
absl::Status describe_fold(const SurfaceMesh& mesh, int triangle);

/// Brings the points of the bilinear grid of the quadrilateral back to the surface.
/// FAILED_PRECONDITION, saying where, when one of them has no triangle.
absl::StatusOr<RegionChart> sample_chart(const SurfaceMesh& mesh, const FlatRegion& region, int n_xi, int n_eta);

/// "(1.0, 2.0, 3.0) mm".
std::string in_mm(const Eigen::Vector3d& position);

}  // namespace lipofill::geometry
