#pragma once

#include <optional>

#include "core/forecast/forecast.h"
#include "lipofill/v1/forecast_service.pb.h"

namespace lipofill::server {

forecast::RetentionSpec to_retention_spec(const v1::Retention& message);
/// Reads what a follow-up measured; a violation of `follow_up` where it measured nothing.
forecast::FollowUp to_follow_up(const v1::FollowUp& message, FieldViolations& violations);
/// The curve at some months, beside that before a follow-up.
v1::RetentionEstimate to_estimate(const forecast::Retention& retention, const forecast::Retention& prior,
                                  const std::vector<double>& months);

}  // namespace lipofill::server
