#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/layered_grid.h"

namespace lipofill::geometry {

/// Scaled Jacobian of a hexahedron: the least, over its corners and its centre, of the determinant
/// of the three normalised edge (at the centre: principal axis) vectors. 1 for a cuboid, not
/// positive when the element is folded, -1 when an edge has no length or a position is not finite.
/// As Verdict defines it (Stimpson et al. 2007).
/// @param nodes  (3, 8) in the order of solid::HexMesh: deep face 0-3, outer face 4-7,
///               anticlockwise seen from outside
/// Checked by tests/unit/solid/hex_quality_test.cc and tests/unit/geometry/chart_test.cc.
double compute_scaled_jacobian(const Eigen::Matrix<double, 3, 8>& nodes);

/// The worst hexahedron of a grid, one turned over against its outer face counting as folded.
struct WorstHexahedron {
  double scaled_jacobian = 1.0;
  int level = 0;  ///< its outer level
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
};

WorstHexahedron find_worst_hexahedron(const LayeredGrid& grid);

/// Middles of the quadrilaterals of the skin [m] under which a hexahedron has a scaled Jacobian
/// below `least`, by levels and then along xi. Checked by tests/unit/geometry/chart_test.cc.
std::vector<Eigen::Vector3d> find_folded_places(const LayeredGrid& grid, double least);

}  // namespace lipofill::geometry
