#pragma once

#include <vector>

#include "core/film/film_grid.h"

namespace lipofill::plan {

/// A closed line along the edges of cells: vertices of the film's grid, each joined to the next and
/// the last to the first.
using OutlineLoop = std::vector<int>;

/// The edge of a zone: one loop around each of its pieces, anticlockwise in the chart, and one
/// around each hole, clockwise. Two pieces that touch in a corner only may share a loop. Checked by
/// tests/unit/plan/zone_outline_test.cc.
std::vector<OutlineLoop> trace_zone_outline(const film::FilmGrid& grid, int zone);

}  // namespace lipofill::plan
