#pragma once

#include "core/mechanics/simulation_state.h"
#include "core/plan/film_layout.h"

namespace lipofill::step {

/// Lets fat enter the cells beside those that it has entered and whose pressure is above the entry
/// pressure of the film: one cell further in every direction. True where it enters any. A film
/// without entry pressure is left as it is. Checked by tests/unit/step/tissue_entry_test.cc.
bool enter_cells_beside_pressure(const plan::FilmLayout& layout, mechanics::FilmState& film);

}  // namespace lipofill::step
