#pragma once

#include "absl/status/status.h"
#include "client/cpp/picture/result_picture.h"

namespace lipofill::client {

/// Draws what a face lacks to its target: the face as it is, and the signed distance on it (blue:
/// the target lies outside, something is missing; red: it lies inside), with the figures by region
/// beside and remarks below. The mesh has the point field "distance_mm", not a number where nothing
/// is compared. 2000 x 900 pixels; needs an X server, as the others. INVALID_ARGUMENT for a mesh
/// that cannot be read or lacks the field. Checked by tests/integration/cli/target_test.cc.
absl::Status draw_deficit_picture(const PictureRequest& request);

}  // namespace lipofill::client
