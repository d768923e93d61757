#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "core/geometry/head_axes.h"
#include "core/planning/rigid_motion.h"

namespace lipofill::planning {

/// The rigid motion that brings the moving landmarks nearest to those of the same names, in least
/// squares (Kabsch 1976); nothing for fewer than three common names, or where they lie on a line.
/// INVALID_ARGUMENT, with the figures, where the landmarks fit less than half as badly with left
/// and right exchanged: they are swapped on one of the surfaces. Checked by
/// tests/unit/planning/registration_test.cc.
absl::StatusOr<std::optional<RigidMotion>> align_landmarks(const geometry::Landmarks& moving,
                                                           const geometry::Landmarks& fixed);

}  // namespace lipofill::planning
