#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/footprint.h"
#include "core/geometry/skin_reach.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// A point of a footprint, brought to the skin.
struct FootprintSample {
  SurfacePoint skin;        ///< the nearest place
  bool is_beyond = false;   ///< it lies beyond a border of the skin
  bool is_outline = false;  ///< on the rim of the ellipse; the others stand for equal shares of it
};

/// Samples a footprint in the tangent plane at its centre, and brings the points to the skin: 96 on
/// the rim, 192 evenly within. A point lies beyond the border when the nearest place is on the
/// border and off to the side.
std::vector<FootprintSample> sample_footprint(const SurfaceMesh& skin, const SkinReach& reach,
                                              const Footprint& footprint);

}  // namespace lipofill::geometry
