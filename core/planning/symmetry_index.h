#pragma once

#include "core/geometry/surface_mesh.h"
#include "core/planning/reflection.h"
#include "core/planning/skin_surface.h"

namespace lipofill::planning {

/// The symmetry index of a part of the face: root of the mean square of the distances from its
/// vertices to the mirror image of the face, of those that lie over it, to 10 mm [m]. 0 where none
/// does. Checked by tests/unit/planning/symmetry_plane_test.cc.
double measure_symmetry_index(const geometry::SurfaceMesh& part, const SkinSurface& face, const Reflection& plane);

}  // namespace lipofill::planning
