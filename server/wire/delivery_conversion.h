#pragma once

#include "absl/status/statusor.h"
#include "core/planning/delivery.h"
#include "lipofill/v1/planning_service.pb.h"

namespace lipofill::server {

/// Reads how fat is to be laid, in SI. INVALID_ARGUMENT with field violations named as in the
/// message. Checked by tests/integration/service/proposal_test.cc.
absl::StatusOr<planning::DeliverySettings> to_delivery_settings(const v1::PlanDeliveryRequest& request);

/// An injection list. Its plan is that of the request with the injections of the list.
v1::Delivery to_delivery(const v1::SimulationSpec& plan, const planning::Delivery& delivery);

}  // namespace lipofill::server
