#pragma once

#include <vector>

#include "core/geometry/chart_box.h"
#include "core/geometry/layered_grid.h"
#include "core/geometry/level.h"
#include "core/geometry/scalar_field.h"

namespace lipofill::plan {

/// A zone as drawn: positive inside, and its outline.
struct DrawnZone {
  geometry::Level level;
  std::vector<geometry::OutlineLoop> outline;
};

/// Distance from the outline of a zone along the skin [m], positive inside, sampled twice as finely
/// as the grid of the tissue and bilinear between.
geometry::ScalarField find_signed_distance(const geometry::LayeredGrid& grid, const DrawnZone& zone);

/// Finds where the fat of each zone may be: inside its outline, and where it feathers no further
/// than its width beyond and no nearer to another zone than to its own. Each level is positive
/// there.
/// @param distances  find_signed_distance of each zone
/// @param widths  how far fat of each zone feathers [m], 0: not at all
/// Checked by tests/unit/plan/zone_feather_test.cc.
std::vector<geometry::Level> feather(const std::vector<DrawnZone>& zones,
                                     const std::vector<geometry::ScalarField>& distances,
                                     const std::vector<double>& widths);

/// The length of a film's extent, along the undeformed skin, at which fat of a zone stops before it
/// has feathered out [m].
double measure_cut_feather(const geometry::LayeredGrid& grid, const geometry::ChartBox& extent,
                           const geometry::ScalarField& distance, double width);

}  // namespace lipofill::plan
