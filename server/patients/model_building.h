#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/model/face_model.h"
#include "lipofill/v1/model.pb.h"
#include "lipofill/v1/patient_service.pb.h"
#include "server/backend/backend.h"
#include "server/security/principal.h"

namespace lipofill::server {

v1::Model to_model(const ModelRecord& record);

/// Starts the operation that builds a model, or finds the one an equal request started. What can be
/// refused at once is.
absl::StatusOr<OperationView> start_model_build(Backend& backend, const Principal& caller,
                                                const v1::BuildModelRequest& request);

}  // namespace lipofill::server
