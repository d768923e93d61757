#include "core/geometry/zone_patch.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/geometry/flat_region.h"
#include "core/geometry/landmark_checks.h"
#include "core/geometry/outer_skin.h"
#include "core/geometry/skin_border.h"
#include "core/geometry/skin_reach.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

/// A patch is cut larger than what it must hold by this: the skin curves, and edges are longer than
/// the way.
constexpr double kPatchSpare = 1.3;
constexpr double kPatchSpareLength = 0.015;  // [m]

/// The ball around the footprints and their margin.
Ball find_ball(const std::vector<Footprint>& footprints, double margin) {
  Ball ball;
  for (const Footprint& footprint : footprints)
    ball.centre += footprint.centre / static_cast<double>(footprints.size());
  for (const Footprint& footprint : footprints) {
    const double reach = std::hypot(footprint.half_length + margin, footprint.half_width + margin);
    ball.radius = std::max(ball.radius, (footprint.centre - ball.centre).norm() + reach);
  }
  return ball;
}

/// Moves the centres of the footprints onto the outer skin.
absl::Status reach_skin(const SurfaceMesh& skin, std::vector<Footprint>& footprints) {
  const SkinReach reach(skin);
  const BorderFinder borders(skin);
  FieldViolations violations;
  for (Footprint& footprint : footprints) {
    const SurfacePoint nearest = reach.find_nearest(footprint.centre);
    const bool is_beyond = borders.is_beyond(footprint.centre, nearest);
    if (const auto reached = reach.reach(footprint.centre)) {
      footprint.centre = reached->position;
    } else if (is_beyond && nearest.distance <= footprint.half_width) {
      footprint.centre = nearest.position;
    } else if (is_beyond) {
      violations.add(footprint.field,
                     absl::StrFormat("is '%s', whose middle lies %.1f mm beyond a border of the skin near %s: the scan "
                                     "ends there; take a scan that reaches farther",
                                     footprint.name, nearest.distance * 1e3, in_mm(nearest.position)));
    } else {
      violations.add(
          footprint.field,
          absl::StrFormat("is '%s', whose middle lies %.1f mm from the outer skin, must be at most %.0f mm "
                          "above it or %.0f mm beneath; check its landmarks",
                          footprint.name, nearest.distance * 1e3, kFarthestFromSkin * 1e3, kDeepestUnderSkin * 1e3));
    }
  }
  return violations.to_status();
}

/// The kind of border at each vertex of a patch.
std::vector<SkinBorder> find_borders(const SurfaceMesh& scan, const SubSurface& skin, const RegionPatch& patch) {
  const std::vector<bool> ends = find_border_vertices(scan);
  const std::vector<bool> folds = find_border_vertices(skin.mesh);
  std::vector<SkinBorder> borders;
  for (const int v : patch.whole_of_vertex) {
    if (v < 0) {
      borders.push_back(SkinBorder::kNone);
    } else {
      borders.push_back(ends[skin.whole_of_vertex[v]] ? SkinBorder::kScanEnd
                        : folds[v]                    ? SkinBorder::kFold
                                                      : SkinBorder::kNone);
    }
  }
  return borders;
}

}  // namespace

absl::StatusOr<RegionPatch> find_patch_around(const ScanRegionSpec& spec, const SurfaceMesh& mesh, const HeadAxes& axes,
                                              const Progress& progress, ChartAroundRequest& request) {
  request.footprints = spec.footprints;
  request.margin = spec.margin;
  request.up = axes.up;
  request.obstacles = find_face_obstacles(spec.landmarks, axes);
  for (const Eigen::Vector3d& bend : spec.sharp_bends) request.obstacles.push_back({kSharpBend, bend});
  const Ball ball = find_ball(request.footprints, request.margin);
  const double radius = kPatchSpare * ball.radius + kPatchSpareLength;
  const SubSurface skin = extract_outer_skin(mesh, {ball.centre, radius + kDeepestUnderSkin});
  if (skin.mesh.triangles.empty()) {
    return field_violation(request.footprints.front().field, "has no outer skin of the scan near it");
  }
  if (const absl::Status reached = reach_skin(skin.mesh, request.footprints); !reached.ok()) return reached;

  if (progress && !progress(0.5, "cutting the region")) {
    return absl::CancelledError("building the geometry was cancelled");
  }
  const SurfacePoint middle =
      SurfaceLocator(skin.mesh).find_nearest(find_ball(request.footprints, request.margin).centre);
  auto patch = cut_patch_around(skin.mesh, {{middle, radius}});
  if (!patch.ok()) return patch.status();
  request.border = find_borders(mesh, skin, *patch);
  for (int& v : patch->whole_of_vertex) v = v < 0 ? -1 : skin.whole_of_vertex[v];
  return patch;
}

}  // namespace lipofill::geometry
