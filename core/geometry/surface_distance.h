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
  double p95 = 0.0;
  double max = 0.0;  ///< the one-sided Hausdorff distance
};

/// Signed distance of each point to a surface through VTK: positive on the outside of its nearest
/// triangle [m].
std::vector<double> compute_signed_distances(const Eigen::Matrix3Xd& points, const SurfaceMesh& surface);
/// The same; CANCELLED once it is unwanted.
absl::StatusOr<std::vector<double>> compute_signed_distances(const Eigen::Matrix3Xd& points, const SurfaceMesh& surface,
                                                             const Unwanted& unwanted);

/// Computes the statistics of the absolute values. All zero for no values.
DistanceStatistics compute_distance_statistics(const std::vector<double>& distances);

/// The distance between a patch of one surface and another surface, both ways.
struct PatchDistance {
  std::vector<double> patch_to_target;  ///< signed, a value a patch vertex [m]
  DistanceStatistics patch_to_target_statistics;
  /// It is taken from those vertices of the target whose nearest point of `patch` is in its inside,
  /// not on its border, and that hang together with the place on the target the patch is nearest
  /// to: the far side of a head is not compared.
  DistanceStatistics target_to_patch_statistics;
};

/// `patch`: the surface made of the patch alone. CANCELLED once it is unwanted. Checked by
/// tests/unit/geometry/surface_distance_test.cc on concentric spheres and parallel planes.
absl::StatusOr<PatchDistance> compute_patch_distance(const SurfaceMesh& patch, const SurfaceMesh& target,
                                                     const Unwanted& unwanted = nullptr);

}  // namespace lipofill::geometry
