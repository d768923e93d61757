#pragma once

#include "absl/status/status.h"
#include "core/model/face_model.h"

namespace lipofill::model {

/// Checks names, materials, thickness requests and supports, without building anything and without
/// the scan; build_face_model() begins with it. Field violations named as in lipofill.v1.ModelSpec.
/// Checked by tests/integration/service/partial_calls_test.cc.
absl::Status check_face_model(const FaceModelSpec& spec);

}  // namespace lipofill::model
