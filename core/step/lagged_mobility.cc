#include "core/step/lagged_mobility.h"

#include "core/mechanics/tissue_system.h"

namespace lipofill::step {

void LaggedMobility::take_up(const mechanics::SimulationState& state) {
  if (!is_used_) return;
  bool is_at_hand = kept_.size() == state.films.size();
  for (size_t f = 0; is_at_hand && f < state.films.size(); ++f) {
    is_at_hand = mechanics::is_same(kept_[f], state.films[f].factored_mobility);
  }
  if (!is_at_hand) keep(state);
}

bool LaggedMobility::is_due(const mechanics::SimulationState& state) const {
  return is_used_ && state.late_pressure_iterations > solver_.pressure_solver().iterations_of_a_preconditioner();
}

void LaggedMobility::renew(const coupling::FilmSolution& at, mechanics::SimulationState& state) {
  if (!is_used_) return;
  solver_.measure_mobility(at, measured_);
  for (size_t f = 0; f < state.films.size(); ++f) state.films[f].factored_mobility = measured_[f];
  state.late_pressure_iterations = 0;
  keep(state);
}

void LaggedMobility::keep(const mechanics::SimulationState& state) {
  kept_.resize(state.films.size());
  for (size_t f = 0; f < state.films.size(); ++f) kept_[f] = state.films[f].factored_mobility;
  solver_.pressure_solver().renew_preconditioner(kept_);
}

}  // namespace lipofill::step
