#pragma once

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "lipofill/v1/planning_service.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// Finds which parts of a face have zones near one another (core/planning/plan_parts.h), and makes
/// one plan of those that do (face_merging.h). INVALID_ARGUMENT with field violations,
/// FAILED_PRECONDITION where parts that touch cannot be one.
/// Checked by tests/integration/faces/several_parts_test.cc.
absl::StatusOr<v1::FaceArrangement> arrange_face(Backend& backend, const v1::ArrangeFaceRequest& request,
                                                 const Unwanted& unwanted);

}  // namespace lipofill::server
