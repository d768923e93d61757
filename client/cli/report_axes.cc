#include "client/cli/report_axes.h"

#include <cmath>
#include <optional>
#include <string>

namespace lipofill::client {
namespace {

constexpr double kShort = 1e-9;

Point point_of(const v1::Vector3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Scales a vector to length 1; none for one that has no length.
std::optional<Point> unit(const Point& v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  if (!(length > kShort)) return std::nullopt;
  return Point{v[0] / length, v[1] / length, v[2] / length};
}

std::optional<Point> left_of(const v1::ScanRegion& region) {
  if (region.axes().has_left()) return point_of(region.axes().left());
  const auto& landmarks = region.landmarks_mm();
  for (const std::string name : {"exocanthion", "zygion", "tragion", "gonion", "cheilion"}) {
    const auto left = landmarks.find(name + "_left");
    const auto right = landmarks.find(name + "_right");
    if (left == landmarks.end() || right == landmarks.end()) continue;
    const Point a = point_of(left->second);
    const Point b = point_of(right->second);
    return Point{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  }
  return std::nullopt;
}

}  // namespace

Axes axes_to_draw(const v1::ModelSpec& model) {
  const Axes of_the_file = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto up = up_of(model.scan_region());
  const auto left = left_of(model.scan_region());
  if (!up || !left) return of_the_file;
  const auto upward = unit(*up);
  const auto forward = upward ? unit(cross(*left, *upward)) : std::nullopt;
  if (!forward) return of_the_file;
  return {cross(*upward, *forward), *upward, *forward};
}

}  // namespace lipofill::client
