#include "core/geometry/outer_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lipofill::geometry {
namespace {

constexpr int kRays = 13;
constexpr int kFreeRaysOfSkin = 4;
constexpr double kLargestIsland = 1e-4;  // [m2]
constexpr double kRayStart = 2e-5;       // [m] above the surface, so that a ray does not meet its own triangle

/// The normal and two rings of six around it, 30 and 60 degrees off.
std::array<Eigen::Vector3d, kRays> make_ray_directions(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d u = normal.unitOrthogonal();
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

/// Number of free rays; where `enough` is given, counted no further than needed to know whether it is reached.
int count_free_rays(const RayTree& rays, const Eigen::Vector3d& position, const Eigen::Vector3d& normal,
                    int enough = 0) {
  const Eigen::Vector3d start = position + kRayStart * normal;
  int free_rays = 0;
  int left = kRays;
  for (const Eigen::Vector3d& direction : make_ray_directions(normal)) {
    if (enough > 0 && (free_rays >= enough || free_rays + left < enough)) break;
    --left;
    if (!rays.is_blocked(start, direction)) ++free_rays;
  }
  return free_rays;
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

}  // namespace

std::vector<bool> find_outer_skin(const SurfaceMesh& mesh, const Across& across, const RayTree& rays,
                                  const std::vector<int>& candidates) {
  std::vector<bool> outer(mesh.triangles.size(), false);
  std::vector<bool> is_candidate(mesh.triangles.size(), false);
  for (const int t : candidates) {
    is_candidate[t] = true;
    const Eigen::Vector3d normal = compute_area_vector(mesh, mesh.triangles[t]).normalized();
    const Eigen::Vector3d centre = compute_centre(mesh, mesh.triangles[t]);
    outer[t] = count_free_rays(rays, centre, normal, kFreeRaysOfSkin) >= kFreeRaysOfSkin;
  }
  take_in_islands(mesh, across, is_candidate, outer);
  return outer;
}

bool is_inside_out(const SurfaceMesh& mesh, const RayTree& rays) {
  constexpr int kSamples = 300;
  const int stride = std::max(1, mesh.n_triangles() / kSamples);
  int free_in_front = 0;
  int free_behind = 0;
  for (int t = 0; t < mesh.n_triangles(); t += stride) {
    const Eigen::Vector3d normal = compute_area_vector(mesh, mesh.triangles[t]).normalized();
    const Eigen::Vector3d centre = compute_centre(mesh, mesh.triangles[t]);
    free_in_front += count_free_rays(rays, centre, normal);
    free_behind += count_free_rays(rays, centre, -normal);
  }
  return free_behind > free_in_front;
}

}  // namespace lipofill::geometry
