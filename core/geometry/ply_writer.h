#pragma once

#include <string>

#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// The surface as a binary PLY file of doubles in metres: read_surface with one metre per unit
/// gives the same bytes of every coordinate back. Checked by
/// tests/unit/geometry/surface_reader_test.cc.
std::string write_ply(const SurfaceMesh& mesh);

}  // namespace lipofill::geometry
