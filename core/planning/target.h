#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/geometry/head_axes.h"
#include "core/geometry/surface_mesh.h"
#include "core/planning/mirrored_face.h"
#include "core/planning/registration.h"
#include "core/planning/symmetry_plane.h"

namespace lipofill::planning {

/// A scan, with what is known of it.
struct MarkedScan {
  geometry::SurfaceMesh surface;
  geometry::Landmarks landmarks;
};

/// The target is what a face is to look like, in the frame of its scan.
struct Target {
  geometry::SurfaceMesh surface;
  std::optional<Registration> registration;  ///< of a surface from elsewhere
  std::optional<SymmetryPlane> plane;        ///< of a mirrored side
};

/// The face of its healthy side alone: that side and its mirror image (make_mirrored_face), about
/// the plane of find_symmetry_plane. INVALID_ARGUMENT for landmarks that cannot be
/// (check_landmarks: left and right swapped, not on the scan), else errors as find_symmetry_plane.
/// Violations name "landmarks_mm". Checked by tests/unit/planning/target_test.cc.
absl::StatusOr<Target> make_mirrored_target(const MarkedScan& face, FaceSide healthy,
                                            const Unwanted& unwanted = nullptr);

/// This tells where a surface from elsewhere is.
enum class SurfacePlacement { kRegistered, kInPlace };

/// A surface from elsewhere, brought into the frame of the face: all of its vertices in their
/// order. FAILED_PRECONDITION, with the figures, where check_registration refuses.
absl::StatusOr<Target> make_surface_target(const MarkedScan& face, const MarkedScan& other, SurfacePlacement placement,
                                           const Unwanted& unwanted = nullptr);

}  // namespace lipofill::planning
