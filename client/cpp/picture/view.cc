#include "client/cpp/picture/view.h"

#include <vtkDataArray.h>
#include <vtkMath.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lipofill::client {
namespace {

using Vector = std::array<double, 3>;

// A face is recognised by what is around the place: how many radii of the region the picture shows,
// and at least how much.
constexpr double kSurroundings = 2.0;
constexpr double kPlateHalfHeight = 0.76;  // takes its place for a plate, which is shown whole
constexpr double kLeastHalfHeight = 92.0;  // [mm]: a cheek with nose and ear

std::vector<double> weights_of(vtkPolyData* surface, const char* name) {
  vtkDataArray* field = surface->GetPointData()->GetArray(name);
  std::vector<double> weights(static_cast<size_t>(surface->GetNumberOfPoints()), 0.0);
  for (size_t i = 0; field != nullptr && i < weights.size(); ++i) {
    double squares = 0.0;
    for (int c = 0; c < field->GetNumberOfComponents(); ++c)
      squares += std::pow(field->GetComponent(static_cast<vtkIdType>(i), c), 2);
    weights[i] = std::isfinite(squares) ? std::sqrt(squares) : 0.0;
  }
  if (*std::max_element(weights.begin(), weights.end()) <= 0.0) std::fill(weights.begin(), weights.end(), 1.0);
  return weights;
}

Vector unit(Vector v, const Vector& otherwise) {
  return vtkMath::Normalize(v.data()) > 0.0 ? v : otherwise;
}

/// The part of `up` across the direction of view; any direction across when there is none.
Vector across(const Vector& direction, const Vector& up) {
  Vector result = up;
  const double along = vtkMath::Dot(up, direction);
  for (size_t i = 0; i < 3; ++i) result[i] -= along * direction[i];
  if (vtkMath::Norm(result.data()) > 1e-3) return unit(result, {0, 0, 1});
  return across(direction, std::abs(direction[1]) < 0.9 ? Vector{0, 1, 0} : Vector{0, 0, 1});
}

}  // namespace

View view_of(vtkPolyData* surface, const char* weight_name, const std::optional<std::array<double, 3>>& up) {
  const std::vector<double> weights = weights_of(surface, weight_name);
  vtkDataArray* normals = surface->GetPointData()->GetNormals();
  View view;
  Vector normal{};
  double total = 0.0;
  for (size_t i = 0; i < weights.size(); ++i) {
    const double* point = surface->GetPoint(static_cast<vtkIdType>(i));
    for (int c = 0; c < 3; ++c) {
      view.focus[static_cast<size_t>(c)] += weights[i] * point[c];
      normal[static_cast<size_t>(c)] += weights[i] * normals->GetComponent(static_cast<vtkIdType>(i), c);
    }
    total += weights[i];
  }
  for (double& coordinate : view.focus) coordinate /= total;
  view.direction = unit(normal, {0, 0, 1});
  const double threshold = 0.1 * *std::max_element(weights.begin(), weights.end());
  double radius = 0.0;
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] < threshold) continue;
    const double* point = surface->GetPoint(static_cast<vtkIdType>(i));
    radius = std::max(radius, std::sqrt(vtkMath::Distance2BetweenPoints(point, view.focus.data())));
  }
  const double whole = 0.5 * surface->GetLength();
  view.half_height_mm = std::min(std::max(kSurroundings * radius, kLeastHalfHeight), whole);
  if (!up) {
    view.half_height_mm = kPlateHalfHeight * whole;
    surface->GetCenter(view.focus.data());
  }
  // A flat plate is seen at a slant, or its bulge would not show.
  const Vector upward = across(view.direction, up.value_or(Vector{0, 1, 0}));
  if (!up) {
    for (size_t i = 0; i < 3; ++i) view.direction[i] = 0.6 * view.direction[i] - 0.8 * upward[i];
  }
  view.up = across(view.direction, up.value_or(normal));
  return view;
}

}  // namespace lipofill::client
