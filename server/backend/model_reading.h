#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/model/face_model.h"
#include "lipofill/v1/model.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// The scans a specification names: ids, empty where it names none.
struct ScanIds {
  std::string skin;
  std::string bone;
};

/// Field violations for names that are of no scan of the patient, relative to the message.
absl::StatusOr<ScanIds> scans_of(const std::string& patient, const v1::ModelSpec& spec);

/// Reads the surfaces of the scans into a specification. Field violations relative to its message.
absl::Status read_scans(Backend& backend, const std::string& patient, const ScanIds& scans, model::FaceModelSpec& spec);

/// A specification in SI, with the surfaces of its scans read. Field violations relative to the
/// message.
absl::StatusOr<model::FaceModelSpec> read_model_spec(Backend& backend, const std::string& patient,
                                                     const v1::ModelSpec& message);

}  // namespace lipofill::server
