#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/footprint.h"
#include "core/model/face_model.h"

namespace lipofill::model {

/// The footprints of what a model is to hold: its named regions and discs, placed by the landmarks.
/// INVALID_ARGUMENT with violations of "scan_region.around" naming the regions that do not exist
/// and the landmarks that are missing. Nothing of the scan's surface is needed. Checked by
/// tests/unit/model/region_footprints_test.cc.
absl::StatusOr<std::vector<geometry::Footprint>> find_footprints(const geometry::ScanRegionSpec& scan,
                                                                 const AroundSpec& around);

}  // namespace lipofill::model
