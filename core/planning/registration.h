#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/geometry/head_axes.h"
#include "core/planning/alignment.h"
#include "core/planning/rigid_motion.h"
#include "core/planning/skin_surface.h"

namespace lipofill::planning {

/// This tells where a registration started.
enum class RegistrationStart { kLandmarks, kShape, kInPlace };

/// A registration tells how one surface lies on another, and how sure that is. Shares and distances
/// are those of samples of the smaller of the two surfaces.
struct Registration {
  RigidMotion motion;  ///< brings the moved surface into the frame of the fixed one
  RegistrationStart start = RegistrationStart::kShape;
  double overlap = 0.0;            ///< share that lies over the other surface, to 10 mm, not beyond its border
  double share_within_1_mm = 0.0;  ///< of those over it
  double median = 0.0;             ///< of their distances [m]
  double inlier_rms = 0.0;         ///< of the distances that count [m]
  double expected_error = 0.0;     ///< as in Certainty [m]
  double rival = 0.0;              ///< score of the best other placement over that of this one
  double mirrored_median = 0.0;    ///< `median` of the mirror image where it fits best [m]
  double mirrored_share = 0.0;     ///< its share within 1 mm; 0 where the mirror image was not tried
  bool is_mirrored = false;        ///< the mirror image fits clearly better: left and right are swapped
  double confidence = 0.0;         ///< in [0, 1]; 0 where check_registration refuses
};

/// Surfaces to register, with what is known of them.
struct RegistrationTask {
  const SkinSurface& moving;
  const SkinSurface& fixed;
  const geometry::Landmarks& moving_landmarks;  ///< they may be empty, as those of the fixed surface
  const geometry::Landmarks& fixed_landmarks;
};

/// Registers a surface rigidly: from landmarks where three names are common, else (or where that
/// leads nowhere) from the shapes alone (search_poses), then by point to plane on the triangles. It
/// gives its figures also where they are poor; check_registration judges them. CANCELLED once it is
/// unwanted. Deterministic to the byte. INVALID_ARGUMENT where landmarks of one surface have left
/// and right swapped against the other's.
/// Checked by tests/unit/planning/registration_test.cc and, on fifteen faces in random poses, by
/// tests/verification/planning/registration_study_test.cc.
absl::StatusOr<Registration> register_surface(const RegistrationTask& task, const Unwanted& unwanted = nullptr);

/// Figures of a surface that lies where it belongs already; nothing is moved.
Registration measure_in_place(const SkinSurface& moving, const SkinSurface& fixed);

/// Bounds beyond which a registration is refused, and the figures from which on it is beyond doubt.
/// Between them confidence rises linearly. The study's page, core/doc/comparison.md, says what
/// scans of one face and of different faces come to.
struct RegistrationBounds {
  double refused = 0.0;
  double certain = 0.0;
};
inline constexpr RegistrationBounds kOverlapBounds{0.3, 0.6};
inline constexpr RegistrationBounds kShareBounds{0.62, 0.85};
inline constexpr RegistrationBounds kErrorBounds{5e-4, 1.5e-4};  // [m]
inline constexpr RegistrationBounds kRivalBounds{0.9, 0.65};

/// FAILED_PRECONDITION naming what is poor, with its figure and bound; `name` is that of the moved
/// surface in the message.
absl::Status check_registration(const Registration& registration, const std::string& name);

}  // namespace lipofill::planning
