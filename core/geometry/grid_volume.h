#pragma once

#include "core/geometry/layered_grid.h"

namespace lipofill::geometry {

/// Volume of all hexahedra of a grid [m3]:
///
///     V = sum over hexahedra of  int |det(dx/dxi)| dxi
///
/// by 2 x 2 x 2 Gauss points, exact for trilinear shapes. 0 without layers.
/// Checked by tests/unit/geometry/grid_volume_test.cc.
double compute_grid_volume(const LayeredGrid& grid);

}  // namespace lipofill::geometry
