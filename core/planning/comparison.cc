#include "core/planning/comparison.h"

#include <algorithm>
#include <utility>

#include "core/geometry/surface_locator.h"

namespace lipofill::planning {
namespace {

bool is_near(const Eigen::Vector3d& point, const Eigen::Matrix3Xd& rim, double width) {
  return rim.cols() > 0 && (rim.colwise() - point).colwise().squaredNorm().minCoeff() < width * width;
}

}  // namespace

absl::StatusOr<Comparison> compare_surfaces(const geometry::SurfaceMesh& part, const geometry::SurfaceMesh& target,
                                            const Unwanted& unwanted) {
  Comparison comparison;
  if (part.triangles.empty() || target.triangles.empty()) return comparison;
  const auto distance = geometry::compute_patch_distance(part, target, unwanted);
  if (!distance.ok()) return distance.status();
  const auto volume = geometry::compute_volume_between(part, target, unwanted);
  if (!volume.ok()) return volume.status();
  comparison.skin_to_target = distance->patch_to_target_statistics;
  comparison.target_to_skin = distance->target_to_patch_statistics;
  comparison.hausdorff = std::max(comparison.skin_to_target.max, comparison.target_to_skin.max);
  comparison.volume = *volume;
  comparison.skin_vertices = part.n_vertices();
  comparison.target_vertices = distance->target_vertices;
  return comparison;
}

absl::StatusOr<std::vector<bool>> find_rim_points(const Eigen::Matrix3Xd& skin, const geometry::SurfaceMesh& target,
                                                  const Rim& rim, const Unwanted& unwanted) {
  std::vector<bool> flags(static_cast<size_t>(skin.cols()), false);
  if (!(rim.width > 0.0) || (rim.of_skin.cols() == 0 && rim.of_target.cols() == 0)) return flags;
  const geometry::SurfaceLocator locator(target);
  constexpr Eigen::Index kPointsBetweenLooks = 256;
  for (Eigen::Index v = 0; v < skin.cols(); ++v) {
    if (v % kPointsBetweenLooks == 0) {
      if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
    }
    const Eigen::Vector3d point = skin.col(v);
    flags[static_cast<size_t>(v)] =
        is_near(point, rim.of_skin, rim.width) ||
        (rim.of_target.cols() > 0 && is_near(locator.find_nearest(point).position, rim.of_target, rim.width));
  }
  return flags;
}

std::vector<int> find_triangles_without(const geometry::SurfaceMesh& mesh, const std::vector<bool>& left_out) {
  std::vector<int> triangles;
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    const auto& corner = mesh.triangles[t];
    if (!left_out[corner[0]] && !left_out[corner[1]] && !left_out[corner[2]]) triangles.push_back(t);
  }
  return triangles;
}

}  // namespace lipofill::planning
