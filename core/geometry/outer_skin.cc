#include "core/geometry/outer_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

namespace lipofill::geometry {
namespace {

constexpr int kRays = 13;
constexpr int kFreeRaysOfSkin = 4;
constexpr double kLargestIsland = 1e-4;  // [m2]
constexpr double kRayStart = 2e-5;       // [m] above the surface, so that a ray does not meet its own triangle

/// The normal and two rings of six around it, 30 and 60 degrees off. They start from a direction of
/// the surface's own, so that a patient turned in space is seen the same.
std::array<Eigen::Vector3d, kRays> make_ray_directions(const Eigen::Vector3d& normal, const Eigen::Vector3d& along) {
  const Eigen::Vector3d u = (along - along.dot(normal) * normal).normalized();
  const Eigen::Vector3d v = normal.cross(u);
  std::array<Eigen::Vector3d, kRays> directions;
  directions[0] = normal;
  for (int k = 0; k < 12; ++k) {
    const double tilt = (k < 6 ? 30.0 : 60.0) * std::numbers::pi / 180.0;
    const double turn = (k + (k < 6 ? 0.0 : 0.5)) * std::numbers::pi / 3.0;
    directions[k + 1] = std::cos(tilt) * normal + std::sin(tilt) * (std::cos(turn) * u + std::sin(turn) * v);
  }
  return directions;
}

/// True when enough of the rays are free for the point to be skin.
bool is_open(const RayTree& rays, const Eigen::Vector3d& position, const Eigen::Vector3d& normal,
             const Eigen::Vector3d& along) {
  const Eigen::Vector3d start = position + kRayStart * normal;
  int free_rays = 0;
  int left = kRays;
  for (const Eigen::Vector3d& direction : make_ray_directions(normal, along)) {
    if (free_rays + left < kFreeRaysOfSkin) return false;
    --left;
    if (!rays.is_blocked(start, direction) && ++free_rays >= kFreeRaysOfSkin) return true;
  }
  return false;
}

Eigen::Vector3d compute_centre(const SurfaceMesh& mesh, const std::array<int, 3>& triangle) {
  return (mesh.points.col(triangle[0]) + mesh.points.col(triangle[1]) + mesh.points.col(triangle[2])) / 3.0;
}

/// Takes over into the skin what is hidden, small, and surrounded by skin alone.
void take_in_islands(const SurfaceMesh& mesh, const Across& across, const std::vector<bool>& is_candidate,
                     std::vector<bool>& outer) {
  std::vector<bool> visited(mesh.triangles.size(), false);
  std::vector<int> island;
  for (int seed = 0; seed < mesh.n_triangles(); ++seed) {
    if (!is_candidate[seed] || outer[seed] || visited[seed]) continue;
    bool surrounded = true;
    double area = 0.0;
    visited[seed] = true;
    island.assign(1, seed);
    for (size_t k = 0; k < island.size(); ++k) {
      area += 0.5 * compute_area_vector(mesh, mesh.triangles[island[k]]).norm();
      for (const int neighbour : across[island[k]]) {
        if (neighbour < 0 || outer[neighbour]) continue;
        surrounded = surrounded && is_candidate[neighbour];
        if (!is_candidate[neighbour] || visited[neighbour]) continue;
        visited[neighbour] = true;
        island.push_back(neighbour);
      }
    }
    if (!surrounded || area > kLargestIsland) continue;
    for (const int t : island) outer[t] = true;
  }
}

std::vector<int> find_triangles_within(const SurfaceMesh& mesh, const Ball& ball) {
  std::vector<int> candidates;
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    const auto& triangle = mesh.triangles[t];
    const bool near = std::any_of(triangle.begin(), triangle.end(),
                                  [&](int v) { return (mesh.points.col(v) - ball.centre).norm() <= ball.radius; });
    if (near) candidates.push_back(t);
  }
  return candidates;
}

}  // namespace

std::vector<bool> find_outer_skin(const SurfaceMesh& mesh, const Across& across, const RayTree& rays,
                                  const std::vector<int>& candidates) {
  std::vector<bool> outer(mesh.triangles.size(), false);
  std::vector<bool> is_candidate(mesh.triangles.size(), false);
  for (const int t : candidates) {
    is_candidate[t] = true;
    const Eigen::Vector3d normal = compute_area_vector(mesh, mesh.triangles[t]).normalized();
    const Eigen::Vector3d centre = compute_centre(mesh, mesh.triangles[t]);
    const Eigen::Vector3d edge = mesh.points.col(mesh.triangles[t][1]) - mesh.points.col(mesh.triangles[t][0]);
    outer[t] = is_open(rays, centre, normal, edge);
  }
  take_in_islands(mesh, across, is_candidate, outer);
  return outer;
}

SubSurface extract_outer_skin(const SurfaceMesh& mesh, const Ball& ball) {
  const std::vector<int> candidates = find_triangles_within(mesh, ball);
  const std::vector<bool> outer = find_outer_skin(mesh, find_neighbours(mesh).across, RayTree(mesh), candidates);
  std::vector<int> skin;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(skin), [&](int t) { return outer[t]; });
  return extract_triangles(mesh, skin);
}

bool is_inside_out(const SurfaceMesh& mesh) {
  const Eigen::Matrix3Xd normals = compute_vertex_normals(mesh);
  double agreement = 0.0;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) < 2) continue;
        const Eigen::Vector3d direction = Eigen::Vector3d(x, y, z).normalized();
        Eigen::Index farthest = 0;
        (direction.transpose() * mesh.points).maxCoeff(&farthest);
        agreement += direction.dot(normals.col(farthest));
      }
    }
  }
  return agreement < 0.0;
}

}  // namespace lipofill::geometry
