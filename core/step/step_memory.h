#pragma once

#include <cstdint>

#include "core/mechanics/held_factor.h"
#include "core/mechanics/tissue_system.h"

namespace lipofill::step {

/// Estimates what a simulation takes in memory with its factor, matrices, steps, states and frames
/// [bytes].
/// @param system, factor  none for films whose walls are not tissue
/// Checked by tests/integration/service/admission_test.cc, where simulations wait for memory.
uint64_t estimate_memory(int n_cells, const mechanics::TissueSystem* system, const mechanics::HeldFactor* factor);

}  // namespace lipofill::step
