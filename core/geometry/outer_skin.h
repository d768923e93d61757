#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/ray_tree.h"
#include "core/geometry/surface_mesh.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {

/// Finds the `candidates` (triangles) that belong to the outer skin: those from which enough of 13
/// rays within 60 degrees of the outward normal leave the scan without meeting it again. The walls
/// of a mouth bag, of a nostril or of a second shell under the skin look at each other and fail.
/// Hidden islands of less than 1 cm2 in the middle of outer skin (the bottom of a crease) count as
/// skin.
/// @return a flag a triangle of the mesh; false for all that are no candidates
/// Checked by tests/unit/geometry/chart_test.cc.
std::vector<bool> find_outer_skin(const SurfaceMesh& mesh, const Across& across, const RayTree& rays,
                                  const std::vector<int>& candidates);

/// A ball in which the skin of a region lies.
struct Ball {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.0;  ///< [m]
};

/// The outer skin with a vertex in a ball, as a surface of its own.
SubSurface extract_outer_skin(const SurfaceMesh& mesh, const Ball& ball);

/// True when the surface is turned inside out: where it reaches farthest in a direction its normal
/// must point that way, by the sum over 98 directions. Inner surfaces reach nowhere farthest, so
/// that they have no say.
bool is_inside_out(const SurfaceMesh& mesh);

}  // namespace lipofill::geometry
