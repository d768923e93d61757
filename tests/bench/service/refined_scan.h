#pragma once

#include <string>

#include "core/geometry/surface_mesh.h"
#include "core/geometry/surface_reader.h"

namespace lipofill::bench {

/// Every triangle cut in four at the middles of its sides: the same surface, four times the
/// triangles.
geometry::SurfaceMesh refine(const geometry::SurfaceMesh& mesh);

/// The bytes of a file that holds the mesh in millimetres: OBJ, binary little-endian PLY or binary
/// STL.
std::string write_scan(const geometry::SurfaceMesh& mesh, geometry::SurfaceFormat format);

}  // namespace lipofill::bench
