#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "core/simulation/simulation.h"

namespace lipofill::simulation {

/// The plan of a settled simulation, at rest on half as many divisions along both directions of the
/// chart (plan::halve_model). FAILED_PRECONDITION with a sentence that says why there is none: the
/// simulation has not settled, has no tissue, too few divisions, or its plan does not come to rest
/// there. Deterministic. Checked by tests/verification/coupling/discretisation_test.cc.
absl::StatusOr<std::unique_ptr<Simulation>> settle_on_half_grid(const Simulation& settled);

/// Tells how many times wider the hexahedra of one grid are than those of the other.
double ratio_of_widths(const Simulation& fine, const Simulation& coarse);

}  // namespace lipofill::simulation
