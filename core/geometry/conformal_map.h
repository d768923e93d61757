#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// Least-squares conformal map of a patch to the plane (Levy et al. 2002). With U = u + iv at the
/// vertices and, in the plane of each triangle of area A, W_j = the edge opposite corner j as a
/// complex number, it minimises
///
///     sum over triangles of |W_0 U_0 + W_1 U_1 + W_2 U_2|^2 / (2 A)
///
/// with vertices `pin_a` and `pin_b` held apart by their distance. Preserves orientation; borders
/// are free; holes may stay open.
/// @return (2, n_vertices) [m]. FAILED_PRECONDITION where the system is singular.
/// Checked by tests/unit/geometry/chart_test.cc.
absl::StatusOr<Eigen::Matrix2Xd> compute_conformal_map(const SurfaceMesh& mesh, int pin_a, int pin_b);

/// Map with mean-value weights (Floater 2003) of a patch whose longest border goes to a circle:
/// free of folds on any disc, but further from conformal. Open holes are spanned by a vertex in
/// their middle.
/// @return (2, n_vertices) [1]. FAILED_PRECONDITION where the system is singular.
absl::StatusOr<Eigen::Matrix2Xd> compute_harmonic_map(const SurfaceMesh& mesh);

}  // namespace lipofill::geometry
