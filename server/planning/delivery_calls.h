#pragma once

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "lipofill/v1/planning_service.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// The injection list of a plan, compared with it where the request asks for that.
absl::StatusOr<v1::Delivery> plan_delivery(Backend& backend, const v1::PlanDeliveryRequest& request,
                                           const Unwanted& unwanted);

}  // namespace lipofill::server
