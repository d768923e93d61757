#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/planning/alignment.h"
#include "core/planning/rigid_motion.h"
#include "core/planning/skin_surface.h"

namespace lipofill::planning {

/// A placement of one surface on another, and the share of its skin that it brings onto the other.
struct Placement {
  RigidMotion motion;
  double score = 0.0;
};

/// Finds how a surface lies on another without any start.
///
/// Two points with their normals, 45 to 110 mm apart, say how a rigid body lies if their images are
/// known. Pairs of the fixed surface are filed by four figures that no motion changes (Drost et al.
/// 2010): their distance, and the angles of both normals with the line between them and with each
/// other. Each pair of the moving surface tries all fixed pairs with the same figures; a placement
/// is scored by the share of 200 samples that come within 7 mm of the skin with their normals
/// agreeing. The best that are distinct are aligned, on a coarse grid, then on a fine one.
///
/// @return distinct placements, best first, scored within 1.5 mm on the fine grid
/// Deterministic: nothing is drawn at random. CANCELLED once it is unwanted.
/// Checked by tests/unit/planning/pose_search_test.cc and
/// tests/verification/planning/registration_study_test.cc.
absl::StatusOr<std::vector<Placement>> search_poses(const SkinSurface& moving, const SkinSurface& fixed,
                                                    const Unwanted& unwanted = nullptr);

}  // namespace lipofill::planning
