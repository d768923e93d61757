#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/planning/comparison.h"
#include "core/planning/deficit.h"
#include "core/planning/target.h"
#include "lipofill/v1/patient_service.pb.h"
#include "lipofill/v1/planning_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::server {

/// A target to make, as the core takes it, yet without the surfaces of its scans.
struct TargetRequest {
  geometry::Landmarks landmarks;                   ///< of the face
  std::optional<planning::FaceSide> healthy_side;  ///< none: from a surface
  geometry::Landmarks surface_landmarks;
  planning::SurfacePlacement placement = planning::SurfacePlacement::kRegistered;
};

/// Reads a specification; field violations relative to it. Checked by
/// tests/unit/server/wire/target_conversion_test.cc, as are the others.
absl::StatusOr<TargetRequest> to_target_request(const v1::TargetSpec& spec);

/// Landmarks [m] of a map in millimetres; violations of `field`.
absl::StatusOr<geometry::Landmarks> to_landmarks(const google::protobuf::Map<std::string, v1::Vector3>& map,
                                                 const std::string& field);

v1::TargetReport to_target_report(const v1::TargetSpec& spec, const planning::Target& target);
v1::Deficit to_deficit(const planning::Deficit& deficit, bool with_distances);
v1::SurfaceComparison to_surface_comparison(const planning::Comparison& comparison);
v1::VolumeToTarget to_volume_to_target(const geometry::VolumeBetween& volume);
/// Statistics of distances that have a sign.
v1::DistanceStatistics to_signed_statistics(const geometry::DistanceStatistics& statistics);

}  // namespace lipofill::server
