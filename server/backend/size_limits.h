#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "core/model/face_model.h"
#include "lipofill/v1/model.pb.h"
#include "lipofill/v1/simulation.pb.h"

namespace lipofill::server {

/// Limits on the size of what clients send; at most what the model itself bears.
struct SizeLimits {
  uint64_t upload_bytes = 256'000'000;
  int hexahedra = 200'000;
  int film_cells = 65'536;
};

/// Checks a specification. RESOURCE_EXHAUSTED with a violation below "spec" for what is larger,
/// before anything is made of it. The message was checked otherwise. Checked by
/// tests/integration/service/admission_test.cc.
absl::Status check_size(const v1::ModelSpec& spec, const SizeLimits& limits);
absl::Status check_size(const v1::SimulationSpec& spec, const SizeLimits& limits);
/// Checks a model that was built: numbers that were left out are known only then.
absl::Status check_size(const model::FaceModel& model, const SizeLimits& limits);

}  // namespace lipofill::server
