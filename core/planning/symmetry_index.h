#pragma once

#include "core/geometry/surface_mesh.h"
#include "core/planning/reflection.h"
#include "core/planning/skin_surface.h"

namespace lipofill::planning {

/// The symmetry index of a part of the face: root of the mean square of the distances from its
/// vertices to the mirror image of the face, of those that lie over it, to 10 mm [m]. 0 where none
/// does. Checked by tests/unit/planning/symmetry_plane_test.cc.
double measure_symmetry_index(const geometry::SurfaceMesh& part, const SkinSurface& face, const Reflection& plane);

/// The same place on another face: the part with each of its vertices at the nearest point of that
/// face's skin, up to 30 mm away; without the triangles of vertices that have none.
geometry::SurfaceMesh lay_onto(const geometry::SurfaceMesh& part, const SkinSurface& face);

}  // namespace lipofill::planning
