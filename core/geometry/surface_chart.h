#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/region_patch.h"

namespace lipofill::geometry {

struct RegionChart {
  Eigen::Matrix3Xd points;  ///< (3, (n_xi + 1) * (n_eta + 1)) on the faceted surface [m], xi fastest
  /// True for a vertex of the patch that lies in the quadrilateral or up to a cell of the grid
  /// beside it. It is false for surface that hangs over the region without being part of its skin,
  /// such as an ear lobe.
  std::vector<bool> is_vertex_near;
};

/// Charts the quadrilateral between the patch's corners: flattens the patch, takes the
/// straight-sided quadrilateral of the corners in the plane, and brings the points of its
/// (n_xi + 1) x (n_eta + 1) bilinear grid back to the surface. INVALID_ARGUMENT (field
/// "scan_region.corners") for corners that run clockwise or make sides that cross, a reflex or a
/// needle corner; FAILED_PRECONDITION, saying where, for a region that runs over a border or a wide
/// hole, and for skin that folds over itself in every map tried.
absl::StatusOr<RegionChart> chart_region(const RegionPatch& patch, int n_xi, int n_eta);

/// Smooths a grid of points over the facets it was sampled from: minimises
///
///     |P - P0|^2 + s^4 integral (|P_xx|^2 + 2 |P_xy|^2 + |P_yy|^2)
///
/// (thin plate), x and y the lengths along the grid's lines, with natural borders, so that features
/// shorter than about 4 s fade and flat regions stay in their places exactly. Second order in s on
/// a smooth surface.
/// @param values  (rows, (n_xi + 1) * (n_eta + 1)), smoothed in place
/// @param spacing mean distance of grid points along xi and eta [m]
/// @param length  s [m]
void smooth_over_grid(int n_xi, int n_eta, const Eigen::Vector2d& spacing, double length, Eigen::Matrix3Xd& values);

/// Mean distance between neighbours along xi and eta [m].
Eigen::Vector2d compute_mean_spacing(int n_xi, int n_eta, const Eigen::Matrix3Xd& points);

/// Unit normals of a grid of points, xi x eta, from central differences (second order, also at the
/// borders).
Eigen::Matrix3Xd compute_grid_normals(int n_xi, int n_eta, const Eigen::Matrix3Xd& points);

}  // namespace lipofill::geometry
