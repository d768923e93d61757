#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/geometry/chart_around.h"
#include "core/geometry/head_axes.h"
#include "core/geometry/surface_locator.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// INVALID_ARGUMENT naming the landmarks whose positions are not finite.
absl::Status check_finite(const Landmarks& landmarks);

/// Checks landmarks against themselves, the head's axes and the scan, and adds remarks on what is
/// unusual:
///
///     left and right are those of the subject, and the nose is in front      else refused
///     the head is 0.35 to 3 times an adult's                                 else refused: another unit
///     the head is 0.7 to 1.4 times an adult's                                else remarked upon
///     a landmark lies on the scan, to 10 mm, or up to 30 mm beyond its end   else refused
///     a landmark lies on the scan, to 5 mm                                   else remarked upon
///
/// @param landmarks  finite
/// @param axes       null where they are neither given nor to be estimated: then the first line is
///                   not checked
/// INVALID_ARGUMENT with violations of "scan_region.landmarks_mm" that name the cause and its
/// figure. Checked by tests/unit/geometry/landmark_checks_test.cc.
absl::Status check_landmarks(const Landmarks& landmarks, const HeadAxes* axes, const SurfaceMesh& scan,
                             const SurfaceLocator& locator, std::vector<std::string>& remarks);

/// Points of the eyes, the mouth and the ears, as far as landmarks tell where they are: the opening
/// of the eye 36 % of the way from its outer corner to the middle of the face, the line of the
/// mouth, the ear 6 mm behind the tragion.
std::vector<Obstacle> find_face_obstacles(const Landmarks& landmarks, const HeadAxes& axes);

}  // namespace lipofill::geometry
