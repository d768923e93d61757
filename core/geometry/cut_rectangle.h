#pragma once

#include <array>
#include <vector>

#include "core/geometry/chart_box.h"
#include "core/geometry/level.h"

namespace lipofill::geometry {

/// Integrals over the part of a rectangle that lies inside outlines, in coordinates s, t of [0,
/// 1] x [0, 1]:
///
///     one = int ds dt, s = int s ds dt, t = int t ds dt, st = int s t ds dt
///
/// They are 1, 1/2, 1/2 and 1/4 for the whole.
struct RectangleMoments {
  double one = 0.0;
  double s = 0.0;
  double t = 0.0;
  double st = 0.0;
};

/// The part of a rectangle in which every level is at least zero. Each quarter of the rectangle is
/// cut along the chord between the places where the outline crosses its sides: third order in the
/// size of the rectangle, so areas of smooth outlines converge with second order. Parts smaller
/// than a billionth count as none, and as the whole. Checked by
/// tests/unit/geometry/cut_rectangle_test.cc.
RectangleMoments integrate_inside(const ChartBox& box, const std::vector<Level>& levels);

/// Shares of the four points of the 2 x 2 Gauss rule, s fastest, with which it integrates 1, s, t
/// and s t over the part exactly; 1 each for the whole rectangle. A share can be negative.
std::array<double, 4> fit_gauss_shares(const RectangleMoments& moments);

}  // namespace lipofill::geometry
