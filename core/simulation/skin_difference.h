#pragma once

#include <vector>

#include "core/simulation/simulation.h"

namespace lipofill::simulation {

/// Squares of the distances between the displacements that two frames have at the nodes of the same
/// skin [mm2] (nodes_per_level); empty where one of them has none. Checked by
/// tests/unit/simulation/preview_test.cc.
std::vector<double> squared_skin_distances(const std::vector<FrameField>& a, const std::vector<FrameField>& b);

}  // namespace lipofill::simulation
