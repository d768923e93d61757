#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/face_geometry.h"

namespace lipofill::anatomy {

/// A named part of the face where fat is injected: an ellipse on the skin, placed by landmarks.
struct Region {
  geometry::LandmarkPoint centre;
  std::string axis_from;     ///< the long axis points from this landmark; empty: across the face
  std::string axis_to;       ///< to this one
  double half_length = 0.0;  ///< [m]
  double half_width = 0.0;   ///< [m]
};

/// Names that find_region knows, without their side: "masseter", ...
std::vector<std::string> region_names();

/// A region by name and side, for example "masseter_left". Sizes are those of an average adult
/// (assumed); placing it multiplies them by compute_head_scale. INVALID_ARGUMENT listing the known
/// names.
absl::StatusOr<Region> find_region(std::string_view name);

/// A region brought to a face: centre and axes in the scan's frame.
struct PlacedRegion {
  Eigen::Vector3d centre;    ///< the centre lies on the skin [m]
  Eigen::Vector3d along;     ///< unit
  double half_length = 0.0;  ///< [m]
  double half_width = 0.0;   ///< [m]
  /// 1 - the distance from the centre in units of the half-axes: positive inside the ellipse.
  double level(const Eigen::Vector3d& point) const;
  bool contains(const Eigen::Vector3d& point) const { return level(point) >= 0.0; }
  /// Distance from the centre in units of the half-axes, along a surface with this normal at the
  /// point: 1 on the rim of the ellipse. The centre may lie above or below the surface.
  double compute_radius(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
};

/// A region where the landmarks put it, on the charted region or not; its centre lies near or
/// beneath the skin, not on it. INVALID_ARGUMENT with the field violation "" naming the landmarks
/// that are missing.
absl::StatusOr<PlacedRegion> place_region_by_landmarks(const geometry::Landmarks& landmarks,
                                                       const geometry::HeadAxes& axes, std::string_view name);
absl::StatusOr<PlacedRegion> place_region_by_landmarks(const geometry::FaceGeometry& face, std::string_view name);

/// Places a region on the charted skin. INVALID_ARGUMENT when a landmark is missing or the centre
/// lies outside the charted region.
absl::StatusOr<PlacedRegion> place_region(const geometry::FaceGeometry& face, std::string_view name);

}  // namespace lipofill::anatomy
