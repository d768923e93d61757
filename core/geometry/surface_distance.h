#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// Statistics of unsigned distances [m].
struct DistanceStatistics {
  double mean = 0.0;
  double rms = 0.0;
  double median = 0.0;  ///< the smallest that half of the values do not exceed
  double p90 = 0.0;     ///< the same of 90 and of 95 in 100
  double p95 = 0.0;
  double max = 0.0;               ///< the one-sided Hausdorff distance
  double share_under_1_mm = 0.0;  ///< of the values
  double share_under_2_mm = 0.0;
  double signed_mean = 0.0;  ///< of the values with their signs [m]
};

/// Signed distance of each point to a surface through VTK: positive on the outside of its nearest
/// triangle [m].
std::vector<double> compute_signed_distances(const Eigen::Matrix3Xd& points, const SurfaceMesh& surface);
/// The same; CANCELLED once it is unwanted.
absl::StatusOr<std::vector<double>> compute_signed_distances(const Eigen::Matrix3Xd& points, const SurfaceMesh& surface,
                                                             const Unwanted& unwanted);

/// Computes the statistics of the absolute values. All zero for no values.
DistanceStatistics compute_distance_statistics(const std::vector<double>& distances);

/// The volume between a patch and a surface that it is moved to [m3].
struct VolumeBetween {
  double deficit = 0.0;  ///< where the surface lies outside the patch
  double excess = 0.0;   ///< where the patch lies outside the surface
};

/// The volume that the patch sweeps when each of its vertices moves straight to its nearest point
/// of the surface: a triangle's share is exact for vertices that move in straight lines,
///
///     V = int_0^1 m . A(s) ds,   A(s) = 1/2 e1(s) x e2(s),   m: mean of the three motions
///
/// and counts by the signs of the distances at its corners. One with both signs counts by distances
/// that are linear over it, times its area in the middle of the motion. CANCELLED once it is
/// unwanted. Checked by tests/unit/geometry/surface_distance_test.cc on plates, tilted plates and
/// spheres.
absl::StatusOr<VolumeBetween> compute_volume_between(const SurfaceMesh& patch, const SurfaceMesh& surface,
                                                     const Unwanted& unwanted = nullptr);
/// The same by triangle of the patch: what is summed up there.
absl::StatusOr<std::vector<VolumeBetween>> compute_volumes_between(const SurfaceMesh& patch, const SurfaceMesh& surface,
                                                                   const Unwanted& unwanted = nullptr);

/// The distance between a patch of one surface and another surface, both ways.
struct PatchDistance {
  std::vector<double> patch_to_target;  ///< signed, a value a patch vertex [m]
  DistanceStatistics patch_to_target_statistics;
  /// It is taken from those vertices of the target whose nearest point of `patch` is in its inside,
  /// not on its border, and that hang together with the place on the target the patch is nearest
  /// to: the far side of a head is not compared.
  DistanceStatistics target_to_patch_statistics;
  int target_vertices = 0;  ///< so many of the target are taken
};

/// `patch`: the surface made of the patch alone. CANCELLED once it is unwanted. Checked by
/// tests/unit/geometry/surface_distance_test.cc on concentric spheres and parallel planes.
absl::StatusOr<PatchDistance> compute_patch_distance(const SurfaceMesh& patch, const SurfaceMesh& target,
                                                     const Unwanted& unwanted = nullptr);

}  // namespace lipofill::geometry
