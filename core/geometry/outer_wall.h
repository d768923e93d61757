#pragma once

#include <optional>
#include <vector>

#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// A scan that is a shell of two walls: thickened for print, or hollow with an inner wall.
struct Shell {
  double thickness = 0.0;      ///< median distance between the walls [m]
  std::vector<bool> is_outer;  ///< a flag a triangle: it is of the outer wall
  size_t n_inner = 0;          ///< triangles of the inner wall and of the rim between the walls
};

/// Finds the walls of a shell. A triangle has a wall behind it where a ray along its normal, one
/// way or the other, meets the surface within 10 mm; a surface is a shell where that holds for 60 %
/// of its area, which no solid head and no single wall comes near. Triangles with a wall behind
/// them at no more than twice the median distance make walls, joined over edges that bend by less
/// than 60 degrees. Of two walls behind one another the outer one is the one that reaches farthest
/// in more of 218 directions; the walls behind an outer one are inner, and the other way round.
/// What lies between the walls goes with the wall that it continues smoothly, and the rim that
/// joins them goes too.
/// @param mesh  without degenerate triangles, at most two triangles an edge
/// @return nothing for a surface that is no shell Deterministic. Checked by
/// tests/unit/geometry/outer_wall_test.cc.
std::optional<Shell> find_shell(const SurfaceMesh& mesh);

}  // namespace lipofill::geometry
