#include "core/geometry/bone_depth.h"

#include <cmath>

#include "absl/strings/str_format.h"
#include "core/geometry/gap_filling.h"
#include "core/geometry/ray_tree.h"
#include "core/geometry/surface_chart.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

/// Distances to the first bone; infinity where there is none [m].
Eigen::VectorXd cast_rays(const LayeredGrid& grid, const SurfaceMesh& bone) {
  const int n = grid.nodes_per_level();
  const Eigen::Matrix3Xd skin = grid.nodes.leftCols(n);
  const Eigen::Matrix3Xd normals = compute_grid_normals(grid.n_xi, grid.n_eta, skin);
  const RayTree rays(bone);
  Eigen::VectorXd depth(n);
  for (int node = 0; node < n; ++node) {
    depth[node] = rays.find_first(skin.col(node), -normals.col(node), kDeepestBone);
  }
  return depth;
}

}  // namespace

absl::StatusOr<BoneDepth> measure_bone_depth(const LayeredGrid& grid, const SurfaceMesh& bone, double smoothing) {
  if (const absl::Status valid = check_indices("scan_region.bone_scan", bone); !valid.ok()) return valid;
  BoneDepth result{cast_rays(grid, bone), 0.0, {}};
  result.missed = (!result.depth.array().isFinite()).cast<double>();
  const auto measured = result.depth.array().isFinite().count();
  result.measured_share = static_cast<double>(measured) / static_cast<double>(result.depth.size());
  if (!(result.measured_share >= kLeastMeasuredShare)) {
    return absl::FailedPreconditionError(
        absl::StrFormat("scan_region.bone_scan: bone lies under %.1f %% of the region within %.0f mm of its skin, must "
                        "be at least %.0f %%; "
                        "skin and bone must be scans in the same frame",
                        100.0 * result.measured_share, kDeepestBone * 1e3, 100.0 * kLeastMeasuredShare));
  }
  fill_harmonically(grid, result.depth);
  smooth_over_skin(grid, smoothing, result.depth);
  return result;
}

void smooth_over_skin(const LayeredGrid& grid, double length, Eigen::VectorXd& values) {
  const Eigen::Vector2d spacing =
      compute_mean_spacing(grid.n_xi, grid.n_eta, grid.nodes.leftCols(grid.nodes_per_level()));
  Eigen::Matrix3Xd rows = Eigen::Matrix3Xd::Zero(3, values.size());
  rows.row(0) = values.transpose();
  smooth_over_grid(grid.n_xi, grid.n_eta, spacing, length, rows);
  values = rows.row(0).transpose();
}

}  // namespace lipofill::geometry
