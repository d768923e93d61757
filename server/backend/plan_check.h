#pragma once

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// Places a plan on its model and answers with what is found; nothing is stored. INVALID_ARGUMENT
/// without a plan or a model's name, RESOURCE_EXHAUSTED for one of more film cells than simulations
/// may have, NOT_FOUND without the model, CANCELLED once it is unwanted. May take seconds where the
/// model has to be built again. Checked by tests/integration/service/plan_check_test.cc.
absl::StatusOr<v1::CheckPlanResponse> check_plan(Backend& backend, const v1::CheckPlanRequest& request,
                                                 const Unwanted& unwanted);

}  // namespace lipofill::server
