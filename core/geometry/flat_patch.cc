#include "core/geometry/flat_patch.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/flat_region.h"
#include "core/geometry/planar_locator.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

constexpr double kBorderStep = 1e-3;      // [m] between samples of a border
constexpr double kObstacleReach = 0.012;  // [m] farther from the skin of the patch an obstacle is none
constexpr double kUpStep = 2e-3;          // [m]

int nearest_vertex(const SurfaceMesh& mesh, const Eigen::Vector3d& position) {
  Eigen::Index nearest = 0;
  (mesh.points.colwise() - position).colwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

double measure_scale(const SurfaceMesh& mesh, const Eigen::Matrix2Xd& flat, const std::vector<Footprint>& footprints) {
  double on_skin = 0.0;
  double in_plane = 0.0;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d corner = mesh.points.col(triangle[0]);
    const bool is_near = std::any_of(footprints.begin(), footprints.end(), [&](const Footprint& footprint) {
      return (corner - footprint.centre).norm() <= footprint.half_length;
    });
    if (!is_near) continue;
    on_skin += compute_area_vector(mesh, triangle).norm();
    in_plane += std::abs(compute_signed_area(flat.col(triangle[0]), flat.col(triangle[1]), flat.col(triangle[2])));
  }
  return on_skin > 0.0 && in_plane > 0.0 ? std::sqrt(in_plane / on_skin) : 1.0;
}

std::string name_border(SkinBorder a, SkinBorder b) {
  if (a == SkinBorder::kScanEnd && b == SkinBorder::kScanEnd) return "a border of the scan";
  if (a != SkinBorder::kNone && b != SkinBorder::kNone) return "a fold of the skin";
  return "";
}

void add_borders(const SurfaceMesh& mesh, const std::vector<SkinBorder>& border, FlatPatch& patch) {
  for (const auto& loop : trace_boundary_loops(mesh, find_neighbours(mesh).across)) {
    for (size_t k = 0; k < loop.size(); ++k) {
      const int a = loop[k];
      const int b = loop[(k + 1) % loop.size()];
      const int steps = 1 + static_cast<int>((mesh.points.col(b) - mesh.points.col(a)).norm() / kBorderStep);
      for (int s = 0; s < steps; ++s) {
        const double t = static_cast<double>(s) / steps;
        patch.obstacles.push_back({name_border(border[a], border[b]),
                                   (1 - t) * mesh.points.col(a) + t * mesh.points.col(b),
                                   (1 - t) * patch.flat.col(a) + t * patch.flat.col(b), true});
      }
    }
  }
}

}  // namespace

std::pair<int, int> choose_pins(const SurfaceMesh& mesh, const std::vector<Footprint>& footprints) {
  const Footprint& longest = *std::max_element(
      footprints.begin(), footprints.end(), [](const auto& a, const auto& b) { return a.half_length < b.half_length; });
  const int a = nearest_vertex(mesh, longest.centre - longest.half_length * longest.along);
  const int b = nearest_vertex(mesh, longest.centre + longest.half_length * longest.along);
  if (a != b) return {a, b};
  Eigen::Index farthest = 0;
  (mesh.points.colwise() - mesh.points.col(a)).colwise().squaredNorm().maxCoeff(&farthest);
  return {a, static_cast<int>(farthest)};
}

FlatPatch place_in_flat(const RegionPatch& region, const ChartAroundRequest& request, const SkinReach& reach,
                        const Samples& samples, Eigen::Matrix2Xd flat) {
  const SurfaceMesh& mesh = region.mesh;
  FlatPatch patch;
  patch.flat = std::move(flat);
  patch.scale = measure_scale(mesh, patch.flat, request.footprints);
  const auto to_plane = [&](const SurfacePoint& point) { return place_in_plane(mesh, patch.flat, point); };
  for (const auto& of_footprint : samples) {
    for (const FootprintSample& sample : of_footprint) {
      (sample.is_outline ? patch.outline : patch.content).push_back(to_plane(sample.skin));
    }
  }
  add_borders(mesh, request.border, patch);
  for (const Obstacle& obstacle : request.obstacles) {
    const SurfacePoint place = reach.find_nearest(obstacle.position);
    if (place.distance > kObstacleReach) continue;
    patch.obstacles.push_back({obstacle.name, place.position, to_plane(place), false});
  }
  const Eigen::Vector3d& centre = request.footprints.front().centre;
  patch.up = to_plane(reach.find_nearest(centre + kUpStep * request.up)) -
             to_plane(reach.find_nearest(centre - kUpStep * request.up));
  return patch;
}

}  // namespace lipofill::geometry
