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

/// Fills the films to their initial thickness and finds the equilibrium with every cell on tissue
/// holding its volume, by load stepping. INVALID_ARGUMENT with the field "films" when the tissue
/// does not come to rest.
absl::Status open_to_initial_thickness(const Opening& opening, mechanics::SimulationState& state);

}  // namespace lipofill::step
