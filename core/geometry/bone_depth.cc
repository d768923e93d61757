#include "core/geometry/bone_depth.h"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <vector>

#include "absl/strings/str_format.h"
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

/// Neighbours of a node in the grid, at most four.
template <typename Visit>
void for_neighbours(const LayeredGrid& grid, int i, int j, const Visit& visit) {
  if (i > 0) visit(grid.surface_index(i - 1, j));
  if (i < grid.n_xi) visit(grid.surface_index(i + 1, j));
  if (j > 0) visit(grid.surface_index(i, j - 1));
  if (j < grid.n_eta) visit(grid.surface_index(i, j + 1));
}

/// Makes every value that is not finite the mean of its neighbours. With one finite value at least
/// the system is positive definite: the grid is connected.
void fill_harmonically(const LayeredGrid& grid, Eigen::VectorXd& values) {
  std::vector<int> unknown(values.size(), -1);
  int n_unknown = 0;
  for (Eigen::Index node = 0; node < values.size(); ++node) {
    if (!std::isfinite(values[node])) unknown[node] = n_unknown++;
  }
  if (n_unknown == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n_unknown);
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      const int row = unknown[grid.surface_index(i, j)];
      if (row < 0) continue;
      for_neighbours(grid, i, j, [&](int neighbour) {
        entries.emplace_back(row, row, 1.0);
        if (unknown[neighbour] < 0) {
          right[row] += values[neighbour];
        } else {
          entries.emplace_back(row, unknown[neighbour], -1.0);
        }
      });
    }
  }
  Eigen::SparseMatrix<double> matrix(n_unknown, n_unknown);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd filled = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
  for (Eigen::Index node = 0; node < values.size(); ++node) {
    if (unknown[node] >= 0) values[node] = filled[unknown[node]];
  }
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
