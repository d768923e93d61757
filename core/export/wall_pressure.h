#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/film/cell_pieces.h"
#include "core/geometry/layered_grid.h"

namespace lipofill::exporting {

/// Pressure on one quadrilateral of a level of the tissue.
struct WallPressure {
  int i = 0;  ///< the quadrilateral's place in the level, 0 .. n_xi - 1
  int j = 0;
  double pressure = 0.0;  ///< [Pa]
};

/// Returns one pressure for every quadrilateral that cells of a film cover, wholly or in part: that
/// of the cells weighted by the share of the quadrilateral, in the chart, that each covers inside
/// its zone's outline. What no cell covers counts with zero pressure, so that sum_q p_q A_q = sum_i
/// p_i A_i with A areas of the chart.
/// @param pieces  of the film's cells on the tissue's quadrilaterals
/// @param pressure  of the cells [Pa] (n_cells)
/// @return ascending in j, then i.
/// Checked by tests/unit/export/calculix_deck_test.cc.
std::vector<WallPressure> spread_over_wall(const geometry::LayeredGrid& tissue,
                                           const std::vector<film::CellPiece>& pieces, const Eigen::VectorXd& pressure);

}  // namespace lipofill::exporting
