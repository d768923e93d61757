#pragma once

#include <optional>

#include "core/geometry/head_axes.h"
#include "core/planning/skin_surface.h"

namespace lipofill::planning {

/// A ball around the face, from its landmarks: its centre is the mean of the eye corners, mouth
/// corners, cheekbones and jaw angles, its radius 1.25 times the distance to the farthest landmark.
/// Hair, neck and shoulders lie outside of it for the most part.
struct FaceBall {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.0;  ///< [m]
};

/// Nothing for fewer than three landmarks.
std::optional<FaceBall> find_face_ball(const geometry::Landmarks& landmarks);

/// The skin with all three vertices in the ball, by triangles (ascending).
std::vector<int> find_triangles_in(const SkinSurface& skin, const FaceBall& ball);

}  // namespace lipofill::planning
