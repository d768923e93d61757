#include "server/backend/evaluation_detail.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/units.h"
#include "core/geometry/surface_cleaning.h"
#include "core/geometry/surface_topology.h"
#include "core/planning/comparison.h"
#include "core/planning/skin_surface.h"
#include "core/planning/symmetry_index.h"
#include "core/planning/symmetry_plane.h"
#include "server/backend/slice_arrays.h"
#include "server/wire/target_conversion.h"

namespace lipofill::server {
namespace {

/// A part of the patch, before and after.
struct PatchPart {
  geometry::SurfaceMesh before;
  geometry::SurfaceMesh after;
};

PatchPart take_part(const SkinPatch& patch, const std::vector<int>& triangles) {
  return {geometry::extract_triangles(patch.before, triangles).mesh,
          geometry::extract_triangles(patch.after, triangles).mesh};
}

absl::StatusOr<v1::SurfaceComparison> compare(const geometry::SurfaceMesh& part, const geometry::SurfaceMesh& target,
                                              const Unwanted& unwanted) {
  const auto comparison = planning::compare_surfaces(part, target, unwanted);
  if (!comparison.ok()) return comparison.status();
  return to_surface_comparison(*comparison);
}

absl::Status compare_both(const PatchPart& part, const geometry::SurfaceMesh& target, const Unwanted& unwanted,
                          v1::SurfaceComparison& before, v1::SurfaceComparison& after) {
  auto first = compare(part.before, target, unwanted);
  if (!first.ok()) return first.status();
  before = *std::move(first);
  auto second = compare(part.after, target, unwanted);
  if (!second.ok()) return second.status();
  after = *std::move(second);
  return absl::OkStatus();
}

/// Triangles of the patch that are not at the rim of the scan or of the target.
absl::StatusOr<std::vector<int>> find_inner_triangles(const model::FaceModel& model, const SkinPatch& patch,
                                                      const geometry::SurfaceMesh& target, double width,
                                                      const Unwanted& unwanted) {
  planning::Rim rim;
  rim.of_skin.resize(3, 0);
  if (!model.is_square) rim.of_skin = planning::find_rim(geometry::clean_surface(model.geometry.scan).mesh);
  rim.of_target = planning::find_rim(geometry::clean_surface(target).mesh);
  rim.width = width;
  const auto flags = planning::find_rim_points(patch.before.points, target, rim, unwanted);
  if (!flags.ok()) return flags.status();
  return planning::find_triangles_without(patch.before, *flags);
}

/// The triangles among these whose three vertices are over the zone.
std::vector<int> find_zone_triangles(const SkinPatch& patch, const std::vector<int>& triangles, const PatchZones& zones,
                                     int zone) {
  std::vector<int> over;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(over), [&](int t) {
    const auto& corner = patch.before.triangles[t];
    return std::all_of(corner.begin(), corner.end(), [&](int v) { return zones.of_vertex[v] == zone; });
  });
  return over;
}

/// The skin of the whole face with the patch as it was simulated.
planning::SkinSurface displace(planning::SkinSurface skin, const SkinPatch& patch) {
  for (int v = 0; v < skin.mesh.n_vertices(); ++v) {
    const auto scan_vertex = static_cast<uint32_t>(skin.scan_vertex[v]);
    const auto found = std::lower_bound(patch.vertices.begin(), patch.vertices.end(), scan_vertex);
    if (found == patch.vertices.end() || *found != scan_vertex) continue;
    skin.mesh.points.col(v) = patch.after.points.col(found - patch.vertices.begin());
  }
  skin.normals = geometry::compute_vertex_normals(skin.mesh);
  return skin;
}

/// Nothing is added for a face whose plane of symmetry cannot be told.
absl::Status add_symmetry(const model::FaceModel& model, const SkinPatch& patch, const PatchPart& inner,
                          const geometry::SurfaceMesh& target, const Unwanted& unwanted, v1::Evaluation& evaluation) {
  if (model.is_square || model.geometry.landmarks.empty()) return absl::OkStatus();
  const auto skin = planning::extract_skin(model.geometry.scan, "the scan");
  if (!skin.ok()) return absl::OkStatus();
  const auto plane = planning::find_symmetry_plane(*skin, model.geometry.landmarks, unwanted);
  if (absl::IsCancelled(plane.status())) return plane.status();
  if (!plane.ok()) return absl::OkStatus();
  const auto index_of = [&](const geometry::SurfaceMesh& part, const planning::SkinSurface& face) {
    return kMillimetresPerMetre * planning::measure_symmetry_index(part, face, plane->reflection);
  };
  evaluation.mutable_symmetry()->set_before_mm(index_of(inner.before, *skin));
  evaluation.mutable_symmetry()->set_simulated_mm(index_of(inner.after, displace(*skin, patch)));
  const auto face = planning::extract_skin(target, "the target");
  if (!face.ok()) return absl::OkStatus();
  const geometry::SurfaceMesh opposite = planning::lay_onto(inner.before, *face);
  if (opposite.triangles.empty()) return absl::OkStatus();
  evaluation.mutable_symmetry()->set_target_mm(index_of(opposite, *face));
  return absl::OkStatus();
}

/// The nearest node of the skin's grid, of which xi runs fastest.
size_t find_node(const geometry::LayeredGrid& grid, const geometry::ChartPoint& place) {
  const auto along = [](double share, int n) {
    return static_cast<size_t>(std::lround(std::clamp(share, 0.0, 1.0) * n));
  };
  return along(place.xi, grid.n_xi) + static_cast<size_t>(grid.n_xi + 1) * along(place.eta, grid.n_eta);
}

}  // namespace

PatchZones find_patch_zones(const model::FaceModel& model, const v1::SimulationSpec& spec, const SkinPatch& patch,
                            const v1::FrameSlice& frame) {
  PatchZones zones;
  const std::vector<float> numbers = read_array<float>(frame.fields(), "skin.zone").value_or(std::vector<float>());
  if (numbers.empty()) return zones;
  for (const v1::Film& film : spec.films()) {
    for (const v1::Zone& zone : film.zones()) zones.names.push_back(zone.name());
  }
  const auto zone_at = [&](size_t node) { return node < numbers.size() ? static_cast<int>(numbers[node]) - 1 : -1; };
  if (model.is_square) {
    for (const uint32_t v : patch.vertices) zones.of_vertex.push_back(zone_at(v));
  } else {
    for (const geometry::Rider& rider : model.geometry.riders) {
      zones.of_vertex.push_back(zone_at(find_node(model.geometry.grid, rider.place)));
    }
  }
  return zones;
}

absl::Status add_details(const model::FaceModel& model, const SkinPatch& patch, const PatchZones& zones,
                         const geometry::SurfaceMesh& target, double rim_width, const Unwanted& unwanted,
                         v1::Evaluation& evaluation) {
  const auto inner = find_inner_triangles(model, patch, target, rim_width, unwanted);
  if (!inner.ok()) return inner.status();
  const PatchPart part = take_part(patch, *inner);
  absl::Status done =
      compare_both(part, target, unwanted, *evaluation.mutable_without_rim_before(), *evaluation.mutable_without_rim());
  for (size_t zone = 0; done.ok() && zone < zones.names.size(); ++zone) {
    const PatchPart over = take_part(patch, find_zone_triangles(patch, *inner, zones, static_cast<int>(zone)));
    v1::ZoneComparison& message = *evaluation.add_zones();
    message.set_zone(zones.names[zone]);
    done = compare_both(over, target, unwanted, *message.mutable_before(), *message.mutable_simulated());
  }
  return done.ok() ? add_symmetry(model, patch, part, target, unwanted, evaluation) : done;
}

}  // namespace lipofill::server
