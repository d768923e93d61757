#pragma once

#include "absl/status/statusor.h"
#include "core/geometry/chart_around.h"
#include "core/geometry/face_geometry.h"
#include "core/geometry/region_patch.h"

namespace lipofill::geometry {

/// Moves the footprints of a specification onto the outer skin and cuts the patch around them.
/// @param mesh     the cleaned scan, right side out
/// @param request  out: what to chart on the patch, the centres of its footprints on the skin
/// INVALID_ARGUMENT with the field of a footprint whose middle has no skin, saying what ends there;
/// CANCELLED.
absl::StatusOr<RegionPatch> find_patch_around(const ScanRegionSpec& spec, const SurfaceMesh& mesh, const HeadAxes& axes,
                                              const Progress& progress, ChartAroundRequest& request);

}  // namespace lipofill::geometry
