#pragma once

#include "absl/status/statusor.h"
#include "core/plan/simulation_spec.h"
#include "lipofill/v1/simulation.pb.h"

namespace lipofill::server {

/// A simulation's specification in SI. INVALID_ARGUMENT with the path of every field that is
/// missing, relative to the message. The model's name and the pace stay with the daemon. Checked by
/// tests/unit/server/wire/conversion_test.cc.
absl::StatusOr<plan::SimulationSpec> to_simulation_spec(const v1::SimulationSpec& message);
absl::StatusOr<plan::InjectionSpec> to_injection_spec(const v1::Injection& message);

}  // namespace lipofill::server
