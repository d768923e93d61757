#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/mechanics/held_factor.h"
#include "core/step/residual_force.h"
#include "core/step/wall_response.h"

namespace lipofill::step {

/// The parts that open the tissue for the films' initial thickness. All of them outlive the call.
struct Opening {
  const std::vector<plan::FilmLayout>& films;
  const mechanics::FilmCells& cells;
  const mechanics::FilmGeometry& geometry;
  const Eigen::VectorXd& rest_volume;  ///< [m3] (n cells)
  mechanics::TissueSystem* system;     ///< null without tissue, as the two below
  mechanics::HeldFactor* factor;
  ResidualForce* forces;
};

/// A cell's thickness is its initial one to this share of it.
inline constexpr double kThicknessTolerance = 1e-6;

/// Fills the films to their initial thickness h0 and finds the equilibrium with every cell on
/// tissue holding its volume, by load stepping:
///
///     V_i = a_i(x) h0_i     volume of cell i [m3], a_i its area on the mid-surface at the positions
///                           x of that equilibrium [m2]
///
/// The areas start as those at rest and follow the walls as they stretch, until V_i / a_i(x) is
/// h0_i in every cell to kThicknessTolerance. INVALID_ARGUMENT with the field "films" when the
/// tissue does not come to rest. Checked by tests/unit/step/initial_opening_test.cc.
absl::Status open_to_initial_thickness(const Opening& opening, mechanics::SimulationState& state);

}  // namespace lipofill::step
