#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/simulation/trial_shape.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/sessions/shape_drag.h"

namespace lipofill::server {

/// Reads what FindShape asks for, but for the plan. Field violations named as in FindShapeRequest.
/// Checked by tests/integration/service/shape_test.cc.
absl::StatusOr<simulation::TrialVolumes> to_trial_volumes(const v1::FindShapeRequest& request);

/// The answer: the figures, then the fields in slices.
/// @param sensitivities  none where the request asks for none
absl::StatusOr<std::vector<v1::FindShapeResponse>> to_find_shape_responses(
    const v1::FindShapeRequest& request, const FoundTrial& found,
    const std::vector<simulation::ShapeSensitivity>& sensitivities);

}  // namespace lipofill::server
