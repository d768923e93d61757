#pragma once

#include <vtkPolyData.h>

#include <array>
#include <optional>

#include "client/cpp/picture/view.h"

namespace lipofill::client {

/// Which way a face looks, unit vectors across one another; left is the subject's own.
struct FaceAxes {
  std::array<double, 3> left = {1, 0, 0};
  std::array<double, 3> up = {0, 1, 0};
  std::array<double, 3> forward = {0, 0, 1};
};

/// The five sides from which a face is photographed.
enum class FaceSide { kRightProfile, kRightOblique, kFront, kLeftOblique, kLeftProfile };

/// A camera at one side of the face. All five look at one point with one scale, so that pictures of
/// the sides, and of the face before and after, can be laid beside one another.
/// @param centre  what they look at; if none is given, the middle of the surface
View face_view(vtkPolyData* surface, const FaceAxes& axes, const std::optional<std::array<double, 3>>& centre,
               FaceSide side);

}  // namespace lipofill::client
