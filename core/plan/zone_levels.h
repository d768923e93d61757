#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/field_violations.h"
#include "core/geometry/level.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::plan {

/// The levels of a zone's shape: all of them are positive inside its outline; a box has one a side,
/// which keeps its corners. `face` outlives the levels. Field violations are named below the zone,
/// "box", "disc.radius_mm", "painted", "region".
absl::StatusOr<std::vector<geometry::Level>> make_zone_levels(const geometry::FaceGeometry& face, const ZoneSpec& zone);

/// Checks a box of the chart, named `field`.
void check_box(const ChartBox& box, const std::string& field, FieldViolations& violations);

}  // namespace lipofill::plan
