#pragma once

#include "absl/status/statusor.h"
#include "core/model/face_model.h"
#include "lipofill/v1/model.pb.h"

namespace lipofill::server {

/// A model's specification in SI, its tissue preset filled in, without the surfaces of scan and
/// bone: the caller puts them into ScanRegionSpec::scan and FaceModelSpec::bone. INVALID_ARGUMENT
/// with the path of every field that is missing, relative to the message. Checked by
/// tests/unit/server/wire/conversion_test.cc.
absl::StatusOr<model::FaceModelSpec> to_face_model_spec(const v1::ModelSpec& message);

}  // namespace lipofill::server
