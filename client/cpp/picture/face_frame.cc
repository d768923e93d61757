#include "client/cpp/picture/face_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace lipofill::client {
namespace {

using Vector = std::array<double, 3>;

constexpr double kMostHalfHeight = 115.0;  // [mm]: a face from below the chin to above the forehead
constexpr double kMargin = 1.06;

double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Finds how far a surface reaches along a direction, from and to.
std::pair<double, double> extent_of(vtkPolyData* surface, const Vector& direction) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
    const double* point = surface->GetPoint(i);
    const double along = dot({point[0], point[1], point[2]}, direction);
    low = std::min(low, along);
    high = std::max(high, along);
  }
  return {low, high};
}

/// From the front towards the subject's left.
double angle_of(FaceSide side) {
  return (static_cast<int>(side) - static_cast<int>(FaceSide::kFront)) * std::numbers::pi / 4;
}

}  // namespace

View face_view(vtkPolyData* surface, const FaceAxes& axes, const std::optional<std::array<double, 3>>& centre,
               FaceSide side) {
  View view;
  double most = 0.0;
  const std::array<const Vector*, 3> directions = {&axes.left, &axes.up, &axes.forward};
  for (const Vector* direction : directions) {
    const auto [low, high] = extent_of(surface, *direction);
    most = std::max(most, 0.5 * kMargin * (high - low));
    // A surface that fits into the picture is seen whole; of a larger one the face is.
    const bool fits = 0.5 * kMargin * (high - low) <= kMostHalfHeight;
    const double along = fits || !centre ? 0.5 * (low + high) : dot(*centre, *direction);
    for (size_t i = 0; i < 3; ++i) view.focus[i] += along * (*direction)[i];
  }
  view.half_height_mm = std::min(most, kMostHalfHeight);
  const double angle = angle_of(side);
  for (size_t i = 0; i < 3; ++i) {
    view.direction[i] = std::cos(angle) * axes.forward[i] + std::sin(angle) * axes.left[i];
  }
  view.up = axes.up;
  return view;
}

}  // namespace lipofill::client
