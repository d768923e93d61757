#include "client/cpp/landmarks_file.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cpp/json_file.h"

namespace lipofill::client {
namespace {

using nlohmann::json;

absl::StatusOr<Point> parse_point(const json& value, const std::string& where) {
  Point point{};
  if (!value.is_array() || value.size() != 3)
    return absl::InvalidArgumentError(absl::StrCat(where, " is not [x, y, z]"));
  for (size_t i = 0; i < 3; ++i) {
    if (!value[i].is_number()) return absl::InvalidArgumentError(absl::StrCat(where, "[", i, "] is not a number"));
    point[i] = value[i].get<double>();
    if (!std::isfinite(point[i])) return absl::InvalidArgumentError(absl::StrCat(where, "[", i, "] is not finite"));
  }
  return point;
}

double mm_per_unit(v1::ScanUnit unit) {
  if (unit == v1::CENTIMETRE) return 10.0;
  return unit == v1::METRE ? 1000.0 : 1.0;
}

absl::StatusOr<double> scale_of(const json& document, const std::string& file, v1::ScanUnit scan_unit) {
  if (!document.contains("units")) return mm_per_unit(scan_unit);
  const json& units = document["units"];
  if (units == "mm") return 1.0;
  if (units == "cm") return 10.0;
  if (units == "m") return 1000.0;
  return absl::InvalidArgumentError(absl::StrCat(file, ": units is ", units.dump(), ", not \"mm\", \"cm\" or \"m\""));
}

absl::StatusOr<Axes> parse_axes(const json& value, const std::string& file) {
  Axes axes;
  for (auto [name, vector] : {std::pair{"left", &axes.left}, {"up", &axes.up}, {"forward", &axes.forward}}) {
    if (!value.is_object() || !value.contains(name))
      return absl::InvalidArgumentError(absl::StrCat(file, ": axes has no \"", name, "\""));
    const auto point = parse_point(value[name], absl::StrCat(file, ": axes.", name));
    if (!point.ok()) return point.status();
    *vector = *point;
  }
  return axes;
}

void set_vector(const Point& point, v1::Vector3* vector) {
  vector->set_x(point[0]);
  vector->set_y(point[1]);
  vector->set_z(point[2]);
}

Point point_of(const v1::Vector3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

}  // namespace

absl::StatusOr<Landmarks> load_landmarks(const std::string& path, v1::ScanUnit scan_unit) {
  const size_t hash = path.rfind('#');
  const std::string file = path.substr(0, hash);
  const std::string key = hash == std::string::npos ? "landmarks" : path.substr(hash + 1);
  const auto document = read_json_file(file);
  if (!document.ok()) return document.status();
  if (!document->is_object() || !document->contains(key) || !(*document)[key].is_object()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file, " has no object \"", key, "\" of landmark names to [x, y, z]"));
  }
  const auto scale = scale_of(*document, file, scan_unit);
  if (!scale.ok()) return scale.status();
  Landmarks landmarks;
  for (const auto& [name, value] : (*document)[key].items()) {
    const auto point = parse_point(value, absl::StrCat(file, ": ", key, ".", name));
    if (!point.ok()) return point.status();
    landmarks.points_mm[name] = {*scale * (*point)[0], *scale * (*point)[1], *scale * (*point)[2]};
  }
  if (document->contains("axes")) {
    auto axes = parse_axes((*document)["axes"], file);
    if (!axes.ok()) return axes.status();
    landmarks.axes = *axes;
  }
  return landmarks;
}

void set_landmarks(const Landmarks& landmarks, v1::ScanRegion* region) {
  for (const auto& [name, point] : landmarks.points_mm) set_vector(point, &(*region->mutable_landmarks_mm())[name]);
  if (!landmarks.axes || region->has_axes()) return;
  set_vector(landmarks.axes->left, region->mutable_axes()->mutable_left());
  set_vector(landmarks.axes->up, region->mutable_axes()->mutable_up());
  set_vector(landmarks.axes->forward, region->mutable_axes()->mutable_forward());
}

std::optional<Point> up_of(const v1::ScanRegion& region) {
  if (region.axes().has_up()) return point_of(region.axes().up());
  const auto& landmarks = region.landmarks_mm();
  const auto above = landmarks.find("nasion");
  for (const char* below : {"subnasale", "pogonion", "menton", "pronasale"}) {
    const auto found = landmarks.find(below);
    if (above == landmarks.end() || found == landmarks.end()) continue;
    const Point a = point_of(above->second);
    const Point b = point_of(found->second);
    return Point{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  }
  return std::nullopt;
}

}  // namespace lipofill::client
