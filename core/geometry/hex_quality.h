#pragma once

#include <Eigen/Core>

#include "core/geometry/layered_grid.h"

namespace lipofill::geometry {

/// Scaled Jacobian of a hexahedron: the smallest over its eight corners of the determinant of the unit vectors along
/// the three edges there. In [-1, 1]; 1 is a cuboid, not positive is folded.
/// @param x  (3, 8) corners in the order of solid::HexMesh: deep face 0-3, outer face 4-7, anticlockwise seen from
/// outside
double compute_scaled_jacobian(const Eigen::Matrix<double, 3, 8>& x);

/// The worst hexahedron of a grid, one turned over against its outer face counting as folded.
struct WorstHexahedron {
  double scaled_jacobian = 1.0;
  int level = 0;  ///< its outer level
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
};

WorstHexahedron find_worst_hexahedron(const LayeredGrid& grid);

}  // namespace lipofill::geometry
