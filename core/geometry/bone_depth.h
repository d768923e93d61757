#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/geometry/layered_grid.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// Distance from the skin to the bone.
struct BoneDepth {
  Eigen::VectorXd depth;        ///< [m] along the inward normal, a value a node of the skin; filled and smoothed
  double measured_share = 0.0;  ///< the share of nodes whose ray met bone
  Eigen::VectorXd missed;       ///< 1 at a node whose ray met no bone, else 0
};

/// Deeper bone than this belongs to another part of the head [m].
inline constexpr double kDeepestBone = 0.060;
/// At least this share of the nodes must meet bone.
inline constexpr double kLeastMeasuredShare = 0.25;

/// Casts a ray from every node of the skin along its inward normal onto the bone. Nodes whose ray
/// meets none within kDeepestBone take the harmonic continuation of those around (no value outside
/// the measured range); then features shorter than about four times the smoothing length fade
/// (smooth_over_grid), such as the step where bone ends.
/// @param grid  of which the skin alone is used
/// @param bone  any surface; its orientation does not matter
/// @param smoothing  length [m]; 0: none
/// INVALID_ARGUMENT (field "scan_region.bone_scan") for a broken surface, FAILED_PRECONDITION when
/// less than kLeastMeasuredShare of the rays meet bone, with the share. Second order in spacing and
/// smoothing. Checked by tests/unit/geometry/bone_depth_test.cc: a sphere out of the middle of
/// another.
absl::StatusOr<BoneDepth> measure_bone_depth(const LayeredGrid& grid, const SurfaceMesh& bone, double smoothing);

/// Smooths values at the nodes of a skin, in place: smooth_over_grid() with the skin's own spacing.
void smooth_over_skin(const LayeredGrid& grid, double length, Eigen::VectorXd& values);

}  // namespace lipofill::geometry
