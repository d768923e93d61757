#include "server/wire/target_conversion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/units.h"
#include "server/wire/chart_conversion.h"
#include "server/wire/report_conversion.h"

namespace lipofill::server {
namespace {

constexpr int kMostLandmarks = 100;

geometry::Landmarks read_landmarks(const google::protobuf::Map<std::string, v1::Vector3>& map,
                                   const FieldReader& reader, const std::string& field) {
  geometry::Landmarks landmarks;
  if (map.size() > kMostLandmarks) {
    reader.wrong(field, absl::StrCat("has ", map.size(), " landmarks, must have at most ", kMostLandmarks));
    return landmarks;
  }
  for (const auto& [name, position] : map) {
    landmarks[name] = read_vector(position, kMetresPerMillimetre, reader.below(absl::StrCat(field, "[", name, "]")));
  }
  return landmarks;
}

planning::FaceSide read_side(const v1::MirroredSide& mirrored, const FieldReader& reader) {
  if (mirrored.healthy_side() == v1::FACE_SIDE_UNSPECIFIED) reader.missing("healthy_side");
  return mirrored.healthy_side() == v1::LEFT ? planning::FaceSide::kLeft : planning::FaceSide::kRight;
}

v1::Vector3 to_vector_mm(const Eigen::Vector3d& vector) {
  v1::Vector3 message;
  message.set_x(vector[0] * kMillimetresPerMetre);
  message.set_y(vector[1] * kMillimetresPerMetre);
  message.set_z(vector[2] * kMillimetresPerMetre);
  return message;
}

const char* start_name(planning::RegistrationStart start) {
  switch (start) {
    case planning::RegistrationStart::kLandmarks:
      return "landmarks";
    case planning::RegistrationStart::kInPlace:
      return "in place";
    default:
      return "shape";
  }
}

v1::Registration to_registration(const planning::Registration& registration) {
  v1::Registration message;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) message.add_rotation(registration.motion.rotation(row, column));
  }
  *message.mutable_translation_mm() = to_vector_mm(registration.motion.translation);
  message.set_start(start_name(registration.start));
  message.set_overlap(registration.overlap);
  message.set_share_within_1_mm(registration.share_within_1_mm);
  message.set_median_mm(registration.median * kMillimetresPerMetre);
  message.set_inlier_rms_mm(registration.inlier_rms * kMillimetresPerMetre);
  message.set_expected_error_mm(registration.expected_error * kMillimetresPerMetre);
  message.set_rival(registration.rival);
  message.set_confidence(registration.confidence);
  return message;
}

/// Tells how the mirrored face lies on the face: what a registration says of it.
v1::Registration to_mirror_registration(const planning::SymmetryPlane& plane) {
  v1::Registration message;
  message.set_start("landmarks");
  message.set_overlap(plane.fit.overlap());
  message.set_share_within_1_mm(plane.fit.share_within(1e-3));
  message.set_median_mm(plane.fit.median() * kMillimetresPerMetre);
  message.set_inlier_rms_mm(plane.inlier_rms * kMillimetresPerMetre);
  return message;
}

v1::SymmetryPlane to_symmetry_plane(const planning::SymmetryPlane& plane) {
  v1::SymmetryPlane message;
  message.mutable_normal()->set_x(plane.reflection.normal[0]);
  message.mutable_normal()->set_y(plane.reflection.normal[1]);
  message.mutable_normal()->set_z(plane.reflection.normal[2]);
  message.set_offset_mm(plane.reflection.offset * kMillimetresPerMetre);
  message.set_turned_degrees(plane.turned / kRadiansPerDegree);
  message.set_moved_mm(plane.moved * kMillimetresPerMetre);
  message.set_symmetry_index_mm(plane.index * kMillimetresPerMetre);
  return message;
}

v1::RegionDeficit to_region_deficit(const planning::RegionDeficit& region) {
  v1::RegionDeficit message;
  message.set_region(region.region);
  message.set_area_cm2(region.area * kSquareCentimetresPerSquareMetre);
  *message.mutable_volume() = to_volume_to_target(region.volume);
  *message.mutable_distance() = to_signed_statistics(region.distance);
  message.set_max_deficit_mm(region.max_deficit * kMillimetresPerMetre);
  message.set_vertices(static_cast<uint32_t>(region.vertices));
  return message;
}

}  // namespace

absl::StatusOr<geometry::Landmarks> to_landmarks(const google::protobuf::Map<std::string, v1::Vector3>& map,
                                                 const std::string& field) {
  FieldViolations violations;
  geometry::Landmarks landmarks = read_landmarks(map, FieldReader("", violations), field);
  if (!violations.empty()) return violations.to_status();
  return landmarks;
}

absl::StatusOr<TargetRequest> to_target_request(const v1::TargetSpec& spec) {
  FieldViolations violations;
  const FieldReader reader("", violations);
  TargetRequest request;
  if (spec.scan().empty()) reader.missing("scan");
  request.landmarks = read_landmarks(spec.landmarks_mm(), reader, "landmarks_mm");
  switch (spec.source_case()) {
    case v1::TargetSpec::kMirrored:
      request.healthy_side = read_side(spec.mirrored(), reader.below("mirrored"));
      if (spec.landmarks_mm().empty()) reader.missing("landmarks_mm");
      break;
    case v1::TargetSpec::kSurface:
      if (spec.surface().scan().empty()) reader.below("surface").missing("scan");
      request.surface_landmarks =
          read_landmarks(spec.surface().landmarks_mm(), reader.below("surface"), "landmarks_mm");
      if (spec.surface().placement() == v1::FaceSurface::IN_PLACE) {
        request.placement = planning::SurfacePlacement::kInPlace;
      }
      break;
    default:
      reader.wrong("source", "is missing: mirrored, or surface");
  }
  if (!violations.empty()) return violations.to_status();
  return request;
}

v1::TargetReport to_target_report(const v1::TargetSpec& spec, const planning::Target& target) {
  v1::TargetReport report;
  report.set_scan(spec.scan());
  if (spec.has_surface()) report.set_surface_scan(spec.surface().scan());
  if (spec.has_mirrored()) report.set_mirrored_side(spec.mirrored().healthy_side() == v1::LEFT ? "left" : "right");
  if (target.registration) *report.mutable_registration() = to_registration(*target.registration);
  if (target.plane) {
    *report.mutable_registration() = to_mirror_registration(*target.plane);
    *report.mutable_plane() = to_symmetry_plane(*target.plane);
  }
  return report;
}

v1::Deficit to_deficit(const planning::Deficit& deficit, bool with_distances) {
  v1::Deficit message;
  *message.mutable_all() = to_region_deficit(deficit.all);
  for (const planning::RegionDeficit& region : deficit.regions) *message.add_regions() = to_region_deficit(region);
  *message.mutable_target_to_skin() = to_distance_statistics(deficit.target_to_skin);
  message.set_hausdorff_mm(deficit.hausdorff * kMillimetresPerMetre);
  if (deficit.symmetry_index) message.set_symmetry_index_mm(*deficit.symmetry_index * kMillimetresPerMetre);
  for (const std::string& remark : deficit.remarks) message.add_remarks(remark);
  if (!with_distances) return message;
  for (const double d : deficit.distances) message.add_distance_mm(static_cast<float>(d * kMillimetresPerMetre));
  return message;
}

v1::SurfaceComparison to_surface_comparison(const planning::Comparison& comparison) {
  v1::SurfaceComparison message;
  *message.mutable_skin_to_target() = to_signed_statistics(comparison.skin_to_target);
  *message.mutable_target_to_skin() = to_distance_statistics(comparison.target_to_skin);
  message.set_hausdorff_mm(comparison.hausdorff * kMillimetresPerMetre);
  *message.mutable_volume() = to_volume_to_target(comparison.volume);
  message.set_skin_vertices(static_cast<uint32_t>(comparison.skin_vertices));
  message.set_target_vertices(static_cast<uint32_t>(comparison.target_vertices));
  return message;
}

v1::VolumeToTarget to_volume_to_target(const geometry::VolumeBetween& volume) {
  v1::VolumeToTarget message;
  message.set_deficit_ml(volume.deficit / kCubicMetresPerMillilitre);
  message.set_excess_ml(volume.excess / kCubicMetresPerMillilitre);
  return message;
}

v1::DistanceStatistics to_signed_statistics(const geometry::DistanceStatistics& statistics) {
  v1::DistanceStatistics message = to_distance_statistics(statistics);
  message.set_signed_mean_mm(statistics.signed_mean * kMillimetresPerMetre);
  return message;
}

}  // namespace lipofill::server
