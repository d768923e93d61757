#pragma once

#include "absl/status/status.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::plan {

/// Checks the ranges of everything in a specification that needs no model to be judged: fat, time,
/// damping, gravity, numbers of films, names. Field violations are named as in
/// lipofill.v1.SimulationSpec, values in the units of those names.
absl::Status check_plan(const SimulationSpec& spec);

/// Tells whether the plan has no more films, injections and probes than it may have: only then is
/// it worth placing.
bool has_placeable_size(const SimulationSpec& spec);

/// Checks that the plan can take one more injection. RESOURCE_EXHAUSTED naming the bound when it
/// cannot.
absl::Status check_room_for_injection(const SimulationSpec& spec);

}  // namespace lipofill::plan
