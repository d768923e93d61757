#pragma once

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "lipofill/v1/planning_service.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// Measures what a face lacks to its target. RESOURCE_EXHAUSTED for a scan of more vertices than an
/// answer holds, unless only figures are asked for.
absl::StatusOr<v1::Deficit> measure_deficit_of(Backend& backend, const v1::MeasureDeficitRequest& request,
                                               const Unwanted& unwanted);

}  // namespace lipofill::server
