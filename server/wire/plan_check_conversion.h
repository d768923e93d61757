#pragma once

#include "core/simulation/plan_check.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::server {

/// The answer about a plan; fields below "spec", findings and outlines up to the bounds that the
/// message states.
/// Checked by tests/unit/server/wire/plan_check_conversion_test.cc.
v1::CheckPlanResponse to_check_plan_response(const simulation::PlanCheck& check);

}  // namespace lipofill::server
