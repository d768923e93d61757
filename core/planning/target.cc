#include "core/planning/target.h"

#include <string>
#include <utility>
#include <vector>

#include "core/base/field_violations.h"
#include "core/geometry/landmark_checks.h"
#include "core/geometry/surface_locator.h"
#include "core/planning/skin_surface.h"

namespace lipofill::planning {
namespace {

/// The checks of a model's landmarks, their violations named "landmarks_mm".
absl::Status check_marks(const geometry::Landmarks& landmarks, const SkinSurface& skin) {
  absl::Status good = geometry::check_finite(landmarks);
  if (good.ok()) {
    const auto axes = geometry::estimate_head_axes(landmarks);
    if (!axes.ok()) return field_violation("landmarks_mm", std::string(axes.status().message()), axes.status().code());
    std::vector<std::string> remarks;
    const geometry::SurfaceLocator locator(skin.mesh);
    good = geometry::check_landmarks(landmarks, &*axes, skin.mesh, locator, remarks);
  }
  if (good.ok()) return good;
  FieldViolations renamed;
  for (const FieldViolation& violation : field_violations_of(good)) {
    renamed.add("landmarks_mm", violation.description);
  }
  return renamed.empty() ? good : renamed.to_status();
}

}  // namespace

absl::StatusOr<Target> make_mirrored_target(const MarkedScan& face, FaceSide healthy, const Unwanted& unwanted) {
  const auto skin = extract_skin(face.surface, "the scan");
  if (!skin.ok()) return skin.status();
  if (absl::Status good = check_marks(face.landmarks, *skin); !good.ok()) return good;
  auto plane = find_symmetry_plane(*skin, face.landmarks, unwanted);
  if (!plane.ok()) return plane.status();
  Target target;
  target.surface = make_mirrored_face(skin->mesh, plane->reflection, healthy);
  target.plane = *std::move(plane);
  return target;
}

absl::StatusOr<Target> make_surface_target(const MarkedScan& face, const MarkedScan& other, SurfacePlacement placement,
                                           const Unwanted& unwanted) {
  const auto skin = extract_skin(face.surface, "the scan");
  if (!skin.ok()) return skin.status();
  const auto surface = extract_skin(other.surface, "the surface");
  if (!surface.ok()) return surface.status();
  auto registration = placement == SurfacePlacement::kInPlace
                          ? absl::StatusOr<Registration>(measure_in_place(*surface, *skin))
                          : register_surface({*surface, *skin, other.landmarks, face.landmarks}, unwanted);
  if (!registration.ok()) return registration.status();
  if (absl::Status good = check_registration(*registration, "the surface"); !good.ok()) return good;
  Target target;
  target.surface = other.surface;
  for (int v = 0; v < target.surface.n_vertices(); ++v) {
    const Eigen::Vector3d point = other.surface.points.col(v);
    target.surface.points.col(v) = registration->motion.apply(point);
  }
  target.registration = *std::move(registration);
  return target;
}

}  // namespace lipofill::planning
