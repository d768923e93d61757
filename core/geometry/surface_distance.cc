#include "core/geometry/surface_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/surface_locator.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

constexpr double kOnEdge = 1e-7;  // a barycentric coordinate below this is on the edge

/// Asks for every so many points, which take some milliseconds, whether they are wanted.
class Patience {
 public:
  explicit Patience(const Unwanted& unwanted) : unwanted_(unwanted) {}
  absl::Status check_next() {
    constexpr size_t kPoints = 256;
    return n_points_++ % kPoints == 0 ? check_wanted(unwanted_) : absl::OkStatus();
  }

 private:
  const Unwanted& unwanted_;
  size_t n_points_ = 0;
};

/// Signs distances with the normal of the nearest face, edge or vertex, those of edges and vertices
/// weighted by the angles around them: the sign is then right everywhere (Baerentzen & Aanaes
/// 2005).
class DistanceSigner {
 public:
  explicit DistanceSigner(const SurfaceMesh& surface)
      : surface_(surface), vertex_normals_(compute_vertex_normals(surface)), across_(find_neighbours(surface).across) {}

  double sign(const SurfacePoint& nearest, const Eigen::Vector3d& point) const {
    return normal_at(nearest).dot(point - nearest.position) < 0.0 ? -nearest.distance : nearest.distance;
  }

  /// True when the nearest point lies on the border of the surface.
  bool is_on_border(const SurfacePoint& nearest, const std::vector<bool>& is_border_vertex) const {
    const Eigen::Vector3d b = compute_barycentric(surface_, nearest.triangle, nearest.position);
    for (int k = 0; k < 3; ++k) {
      if (across_[nearest.triangle][k] < 0 && b[(k + 2) % 3] < kOnEdge) return true;
      if (b[k] > 1.0 - kOnEdge && is_border_vertex[surface_.triangles[nearest.triangle][k]]) return true;
    }
    return false;
  }

  std::vector<bool> find_border_vertices() const {
    std::vector<bool> border(surface_.n_vertices(), false);
    for (int t = 0; t < surface_.n_triangles(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (across_[t][k] >= 0) continue;
        border[surface_.triangles[t][k]] = border[surface_.triangles[t][(k + 1) % 3]] = true;
      }
    }
    return border;
  }

 private:
  Eigen::Vector3d face_normal(int t) const { return compute_area_vector(surface_, surface_.triangles[t]).normalized(); }

  Eigen::Vector3d normal_at(const SurfacePoint& nearest) const {
    const Eigen::Vector3d b = compute_barycentric(surface_, nearest.triangle, nearest.position);
    for (int k = 0; k < 3; ++k) {
      if (b[k] > 1.0 - kOnEdge) return vertex_normals_.col(surface_.triangles[nearest.triangle][k]);
    }
    Eigen::Vector3d normal = face_normal(nearest.triangle);
    for (int k = 0; k < 3; ++k) {
      const int neighbour = across_[nearest.triangle][k];
      if (b[(k + 2) % 3] < kOnEdge && neighbour >= 0) normal += face_normal(neighbour);
    }
    return normal;
  }

  const SurfaceMesh& surface_;
  Eigen::Matrix3Xd vertex_normals_;
  Across across_;
};

/// Vertices of the triangles of `target` that are nearest to the vertices of `patch`, ascending.
absl::StatusOr<std::vector<int>> find_facing_vertices(const SurfaceMesh& patch, const SurfaceMesh& target,
                                                      Patience& patience) {
  std::vector<bool> facing(target.n_vertices(), false);
  const SurfaceLocator locator(target);
  for (int v = 0; v < patch.n_vertices(); ++v) {
    if (absl::Status wanted = patience.check_next(); !wanted.ok()) return wanted;
    for (const int w : target.triangles[locator.find_nearest(patch.points.col(v)).triangle]) facing[w] = true;
  }
  std::vector<int> vertices;
  for (int w = 0; w < target.n_vertices(); ++w) {
    if (facing[w]) vertices.push_back(w);
  }
  return vertices;
}

/// The vertices each vertex shares a triangle with; some more than once.
std::vector<std::vector<int>> list_neighbours(const SurfaceMesh& mesh) {
  std::vector<std::vector<int>> beside(mesh.n_vertices());
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      beside[t[k]].push_back(t[(k + 1) % 3]);
      beside[t[k]].push_back(t[(k + 2) % 3]);
    }
  }
  return beside;
}

/// Nearest points on the patch of the part of the target that lies over it: from the vertices the
/// patch is nearest to, along edges, as far as the nearest point stays off the patch's border. The
/// far side of the head, whose nearest point may be in the patch's inside as well, is not reached.
absl::StatusOr<std::vector<SurfacePoint>> find_opposite_vertices(const SurfaceMesh& patch, const SurfaceMesh& target,
                                                                 Patience& patience) {
  const SurfaceLocator locator(patch);
  const DistanceSigner signer(patch);
  const std::vector<bool> border = signer.find_border_vertices();
  const std::vector<std::vector<int>> beside = list_neighbours(target);
  auto facing = find_facing_vertices(patch, target, patience);
  if (!facing.ok()) return facing.status();
  std::vector<int> front = *std::move(facing);
  std::vector<bool> seen(target.n_vertices(), false);
  for (const int v : front) seen[v] = true;
  std::vector<SurfacePoint> opposite;
  for (size_t k = 0; k < front.size(); ++k) {
    if (absl::Status wanted = patience.check_next(); !wanted.ok()) return wanted;
    const SurfacePoint nearest = locator.find_nearest(target.points.col(front[k]));
    if (signer.is_on_border(nearest, border)) continue;
    opposite.push_back(nearest);
    for (const int v : beside[front[k]]) {
      if (seen[v]) continue;
      seen[v] = true;
      front.push_back(v);
    }
  }
  return opposite;
}

/// A triangle whose corners move in straight lines.
struct MovingTriangle {
  std::array<Eigen::Vector3d, 3> corners, motions;

  Eigen::Vector3d area_at(double s) const {
    const auto edge = [&](int k) -> Eigen::Vector3d { return corners[k] - corners[0] + s * (motions[k] - motions[0]); };
    return 0.5 * edge(1).cross(edge(2));
  }
  double swept_volume() const {
    const Eigen::Vector3d mean = (motions[0] + motions[1] + motions[2]) / 3.0;
    return std::abs(mean.dot(area_at(0.0) + 4.0 * area_at(0.5) + area_at(1.0))) / 6.0;  // exact: quadratic in s
  }
};

/// The mean over a triangle of the positive part of distances that are linear over it.
double mean_of_positive_part(std::array<double, 3> d) {
  std::sort(d.begin(), d.end());
  const double mean = (d[0] + d[1] + d[2]) / 3.0;
  if (d[0] >= 0.0) return mean;
  if (d[2] <= 0.0) return 0.0;
  // One corner alone has its sign: over the part it cuts off the distance falls from its own to 0.
  if (d[1] <= 0.0) return d[2] * d[2] * d[2] / (3.0 * (d[2] - d[0]) * (d[2] - d[1]));
  return mean - d[0] * d[0] * d[0] / (3.0 * (d[0] - d[1]) * (d[0] - d[2]));
}

}  // namespace

std::vector<double> compute_signed_distances(const Eigen::Matrix3Xd& points, const SurfaceMesh& surface) {
  return *compute_signed_distances(points, surface, nullptr);
}

absl::StatusOr<std::vector<double>> compute_signed_distances(const Eigen::Matrix3Xd& points, const SurfaceMesh& surface,
                                                             const Unwanted& unwanted) {
  Patience patience(unwanted);
  std::vector<double> distances(static_cast<size_t>(points.cols()), 0.0);
  if (surface.triangles.empty()) return distances;
  const SurfaceLocator locator(surface);
  const DistanceSigner signer(surface);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (absl::Status wanted = patience.check_next(); !wanted.ok()) return wanted;
    distances[static_cast<size_t>(k)] = signer.sign(locator.find_nearest(points.col(k)), points.col(k));
  }
  return distances;
}

DistanceStatistics compute_distance_statistics(const std::vector<double>& distances) {
  DistanceStatistics statistics;
  if (distances.empty()) return statistics;
  std::vector<double> magnitudes;
  for (const double d : distances) magnitudes.push_back(std::abs(d));
  std::sort(magnitudes.begin(), magnitudes.end());
  double squares = 0.0;
  for (const double d : magnitudes) statistics.mean += d, squares += d * d;
  const auto n = static_cast<double>(magnitudes.size());
  // The smallest value that at least this share does not exceed.
  const auto quantile = [&](double share) { return magnitudes[static_cast<size_t>(std::ceil(share * n)) - 1]; };
  const auto share_under = [&](double distance) {
    const auto end = std::lower_bound(magnitudes.begin(), magnitudes.end(), distance);
    return static_cast<double>(end - magnitudes.begin()) / n;
  };
  statistics.mean /= n;
  statistics.rms = std::sqrt(squares / n);
  statistics.median = quantile(0.5);
  statistics.p90 = quantile(0.9);
  statistics.p95 = quantile(0.95);
  statistics.max = magnitudes.back();
  statistics.share_under_1_mm = share_under(1e-3);
  statistics.share_under_2_mm = share_under(2e-3);
  for (const double d : distances) statistics.signed_mean += d / n;
  return statistics;
}

absl::StatusOr<std::vector<VolumeBetween>> compute_volumes_between(const SurfaceMesh& patch, const SurfaceMesh& surface,
                                                                   const Unwanted& unwanted) {
  std::vector<VolumeBetween> volumes(patch.triangles.size());
  if (patch.triangles.empty() || surface.triangles.empty()) return volumes;
  Patience patience(unwanted);
  const SurfaceLocator locator(surface);
  const DistanceSigner signer(surface);
  Eigen::Matrix3Xd motion(3, patch.n_vertices());
  std::vector<double> distance;
  for (int v = 0; v < patch.n_vertices(); ++v) {
    if (absl::Status wanted = patience.check_next(); !wanted.ok()) return wanted;
    const SurfacePoint nearest = locator.find_nearest(patch.points.col(v));
    motion.col(v) = nearest.position - patch.points.col(v);
    distance.push_back(signer.sign(nearest, patch.points.col(v)));
  }
  for (size_t i = 0; i < patch.triangles.size(); ++i) {
    const auto& t = patch.triangles[i];
    VolumeBetween& volume = volumes[i];
    MovingTriangle moving;
    std::array<double, 3> distances{};
    for (int k = 0; k < 3; ++k) {
      moving.corners[k] = patch.points.col(t[k]);
      moving.motions[k] = motion.col(t[k]);
      distances[k] = distance[static_cast<size_t>(t[k])];
    }
    const auto [least, most] = std::minmax_element(distances.begin(), distances.end());
    if (*least >= 0.0 || *most <= 0.0) {
      (*least >= 0.0 ? volume.excess : volume.deficit) = moving.swept_volume();
      continue;
    }
    const double outside = mean_of_positive_part(distances);
    const double inside = outside - (distances[0] + distances[1] + distances[2]) / 3.0;
    const double area = moving.area_at(0.5).norm();
    volume.excess = area * outside;
    volume.deficit = area * inside;
  }
  return volumes;
}

absl::StatusOr<VolumeBetween> compute_volume_between(const SurfaceMesh& patch, const SurfaceMesh& surface,
                                                     const Unwanted& unwanted) {
  const auto volumes = compute_volumes_between(patch, surface, unwanted);
  if (!volumes.ok()) return volumes.status();
  VolumeBetween sum;
  for (const VolumeBetween& volume : *volumes) {
    sum.deficit += volume.deficit;
    sum.excess += volume.excess;
  }
  return sum;
}

absl::StatusOr<PatchDistance> compute_patch_distance(const SurfaceMesh& patch, const SurfaceMesh& target,
                                                     const Unwanted& unwanted) {
  auto distances = compute_signed_distances(patch.points, target, unwanted);
  if (!distances.ok()) return distances.status();
  PatchDistance result;
  result.patch_to_target = *std::move(distances);
  result.patch_to_target_statistics = compute_distance_statistics(result.patch_to_target);
  if (patch.triangles.empty() || target.triangles.empty()) return result;
  Patience patience(unwanted);
  const auto opposite = find_opposite_vertices(patch, target, patience);
  if (!opposite.ok()) return opposite.status();
  std::vector<double> target_to_patch;
  for (const SurfacePoint& nearest : *opposite) target_to_patch.push_back(nearest.distance);
  result.target_to_patch_statistics = compute_distance_statistics(target_to_patch);
  result.target_vertices = static_cast<int>(target_to_patch.size());
  return result;
}

}  // namespace lipofill::geometry
