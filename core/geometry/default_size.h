#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/footprint.h"

namespace lipofill::geometry {

/// Quadrilaterals of the skin are this wide where nothing says otherwise [m]: a third of the width
/// of a firm septum, which they have to resolve. On `jaw_contour` lift and pressure are then off by
/// some 1 and 3 %.
inline constexpr double kDefaultWidth = 4e-3 / 3.0;
/// Zones narrower than four quadrilaterals in their half width get narrower ones, down to this [m].
inline constexpr double kNarrowestDefaultWidth = 1e-3;
/// A default grid has at most so many quadrilaterals: a larger region gets wider ones.
inline constexpr int kMostDefaultQuadrilaterals = 3500;

/// Divisions of a chart along xi and eta.
struct GridSize {
  int n_xi = 0;
  int n_eta = 0;
};

/// Chooses the divisions of a chart with sides of mean lengths `lengths` [m], even numbers, so that
/// its quadrilaterals are as wide as the constants above say for the footprints, as near as whole
/// numbers allow. Checked by tests/unit/geometry/default_size_test.cc.
GridSize choose_grid_size(const Eigen::Vector2d& lengths, const std::vector<Footprint>& footprints);

/// Chooses the hexahedra through a layer: as few as leave none more than twice as thick as it is
/// wide, at most 4, since thin tall ones have a soft mode of the thickness.
/// @param thickness  mean of the layer [m]
/// @param width      mean width of the quadrilaterals of the skin [m]
int choose_elements_through(double thickness, double width);

}  // namespace lipofill::geometry
