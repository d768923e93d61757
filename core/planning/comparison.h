#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/geometry/surface_distance.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::planning {

/// A comparison tells how near a part of the skin is to its target, both ways.
/// core/doc/comparison.md defines every figure.
struct Comparison {
  geometry::DistanceStatistics skin_to_target;
  geometry::DistanceStatistics target_to_skin;
  double hausdorff = 0.0;  ///< the larger of the two maxima [m]
  geometry::VolumeBetween volume;
  int skin_vertices = 0;
  int target_vertices = 0;  ///< those that face the part
};

/// Compares a part of the skin, a surface made of that part alone, with a target. All zero for a
/// part without triangles. CANCELLED once it is unwanted. Checked by
/// tests/unit/planning/comparison_test.cc on planes and spheres, whose distances are known.
absl::StatusOr<Comparison> compare_surfaces(const geometry::SurfaceMesh& part, const geometry::SurfaceMesh& target,
                                            const Unwanted& unwanted = nullptr);

/// The rim is where a scan and its target end.
struct Rim {
  Eigen::Matrix3Xd of_skin;    ///< vertices, as find_rim [m]
  Eigen::Matrix3Xd of_target;  ///< the same
  double width = 0.0;          ///< what is nearer than this belongs to it [m]; 0: nothing does
};

/// A flag for each point of the skin: it belongs to the rim, or its nearest place on the target
/// does. CANCELLED once it is unwanted.
absl::StatusOr<std::vector<bool>> find_rim_points(const Eigen::Matrix3Xd& skin, const geometry::SurfaceMesh& target,
                                                  const Rim& rim, const Unwanted& unwanted = nullptr);

/// Triangles (ascending) none of whose vertices is left out.
std::vector<int> find_triangles_without(const geometry::SurfaceMesh& mesh, const std::vector<bool>& left_out);

}  // namespace lipofill::planning
