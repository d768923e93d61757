#pragma once

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/geometry/head_axes.h"
#include "core/planning/alignment.h"
#include "core/planning/reflection.h"
#include "core/planning/skin_surface.h"

namespace lipofill::planning {

/// A face's plane of symmetry.
struct SymmetryPlane {
  Reflection reflection;    ///< its normal points to the subject's left
  double turned = 0.0;      ///< against the plane of the landmarks [rad]
  double moved = 0.0;       ///< the same, at the middle of the face [m]
  Fit fit;                  ///< of the face on its mirror image, to 10 mm
  double inlier_rms = 0.0;  ///< of the distances that count [m]
  double index = 0.0;       ///< root of the mean square of the distances in `fit`: the symmetry index [m]
};

/// The plane through the midline of the landmarks, square to the line from right to left.
/// FAILED_PRECONDITION as estimate_head_axes.
absl::StatusOr<Reflection> find_landmark_plane(const geometry::Landmarks& landmarks);

/// The midsagittal plane: that of the landmarks, moved until the mirrored face lies on the face.
///
///     min over n, d  of  sum w(r_k) r_k^2,   r_k = n_k . (S p_k - q_k),   S p = p - 2 (n.p - d) n
///
/// p_k: samples of the skin in the face's ball; q_k, n_k: place and normal on the skin that belong
/// to S p_k; w: Tukey's biweight, for which places where the sides differ, as a sick side does,
/// count for nothing. Gauss-Newton in the three unknowns of the plane.
/// FAILED_PRECONDITION, with the figures, where the sides do not fit each other, or only far from
/// where the landmarks say. Checked by tests/unit/planning/symmetry_plane_test.cc.
absl::StatusOr<SymmetryPlane> find_symmetry_plane(const SkinSurface& skin, const geometry::Landmarks& landmarks,
                                                  const Unwanted& unwanted = nullptr);

}  // namespace lipofill::planning
