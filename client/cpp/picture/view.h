#pragma once

#include <array>
#include <optional>

class vtkPolyData;

namespace lipofill::client {

/// A parallel camera.
struct View {
  std::array<double, 3> focus{};
  std::array<double, 3> direction{};  ///< unit, from the focus to the camera
  std::array<double, 3> up{};
  double half_height_mm = 0.0;
};

/// Looks at where `weight_name` (a point field; vectors by their length, numbers by their size) is
/// large, along the mean outward normal there, with some of the surroundings for orientation.
/// Without any weight: at the whole surface. Precondition: the surface has point normals.
View view_of(vtkPolyData* surface, const char* weight_name, const std::optional<std::array<double, 3>>& up);

}  // namespace lipofill::client
