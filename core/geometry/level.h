#pragma once

#include <functional>
#include <vector>

#include "core/geometry/face_geometry.h"

namespace lipofill::geometry {

/// A function of the chart that is positive inside an outline, zero on it and negative outside.
using Level = std::function<double(const ChartPoint&)>;

/// Finds where a function of [0, 1] with values of opposite sign at the ends is zero: three steps
/// of false position, the first of which is exact where the function is linear.
double find_zero(double value_at_0, double value_at_1, const std::function<double(double)>& value_at);

/// A closed line around what is inside, which lies to its left: the last point is joined to the
/// first.
using OutlineLoop = std::vector<ChartPoint>;

/// The zero line of a level on the unit square, by marching squares on n_xi x n_eta rectangles: a
/// loop around each part and one around each hole. Along the border of the chart, beyond which
/// nothing is inside, a loop keeps to the border.
/// Checked by tests/unit/geometry/level_test.cc.
std::vector<OutlineLoop> trace_outline(const Level& level, int n_xi, int n_eta);

}  // namespace lipofill::geometry
