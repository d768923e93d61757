#include "client/cpp/landmarks_file.h"

#include <cmath>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/json_file.h"
#include "client/cpp/landmark_formats.h"
#include "client/cpp/landmark_names.h"

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

/// The file and the object in it. A '#' of a folder, or of a file that there is, names no object.
std::pair<std::string, std::string> split_path(const std::string& path) {
  const size_t hash = path.rfind('#');
  const size_t slash = path.rfind('/');
  std::error_code error;
  const bool is_of_folder = slash != std::string::npos && hash != std::string::npos && hash < slash;
  if (hash == std::string::npos || is_of_folder || std::filesystem::is_regular_file(path, error)) return {path, ""};
  return {path.substr(0, hash), path.substr(hash + 1)};
}

/// The ending that names a format, in lower case; any other file is JSON.
std::string ending_of(const std::string& file) {
  const std::string ending = absl::AsciiStrToLower(std::filesystem::path(file).extension().string());
  for (const char* known : {".fcsv", ".pp", ".csv", ".tsv", ".txt"}) {
    if (ending == known) return ending;
  }
  return ".json";
}

absl::Status in_file(const std::string& file, const absl::Status& status) {
  return absl::InvalidArgumentError(absl::StrCat(file, ": ", std::string(status.message())));
}

absl::StatusOr<LandmarkList> read_list(const std::string& file, const std::string& ending) {
  const auto text = read_text_file(file);
  if (!text.ok()) return text.status();
  if (ending == ".fcsv") return parse_fcsv(*text);
  if (ending == ".pp") return parse_picked_points(*text);
  return parse_landmark_table(*text);
}

/// Landmarks by the daemon's names, from a list in whatever names.
absl::StatusOr<Landmarks> take_list(const LandmarkList& list, const std::string& file, v1::ScanUnit scan_unit) {
  const double scale = list.mm_per_unit.value_or(mm_per_unit(scan_unit));
  Landmarks landmarks;
  std::map<std::string, std::string> name_in_file;
  size_t not_known = 0;
  for (const auto& [given, point] : list.points) {
    const auto understood = understand_landmark_name(given);
    const std::string name = understood.value_or(given);
    if (!understood) ++not_known;
    const auto [entry, is_new] = name_in_file.try_emplace(name, given);
    if (!is_new) {
      return absl::InvalidArgumentError(
          absl::StrCat(file, ": the landmark ", name, " is there twice, as '", entry->second, "' and '", given, "'"));
    }
    landmarks.points_mm[name] = {scale * point[0], scale * point[1], scale * point[2]};
  }
  if (landmarks.points_mm.empty()) return absl::InvalidArgumentError(absl::StrCat(file, " has no landmark"));
  if (list.was_ras) landmarks.remarks.push_back("The landmarks are in RAS and were turned to LPS.");
  if (list.passed_over > 0) {
    landmarks.remarks.push_back(
        absl::StrCat(list.passed_over, " of the points are not placed, or have no name, and were passed over."));
  }
  if (not_known > 0) {
    landmarks.remarks.push_back(
        absl::StrCat(not_known, " of the names are not known as landmarks and stay as they are."));
  }
  return landmarks;
}

/// The project's own JSON.
absl::StatusOr<Landmarks> read_own_json(const json& document, const std::string& file, const std::string& key,
                                        v1::ScanUnit scan_unit) {
  if (!document.is_object() || !document.contains(key) || !document[key].is_object()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file, " has no object \"", key, "\" of landmark names to [x, y, z]"));
  }
  const auto scale = scale_of(document, file, scan_unit);
  if (!scale.ok()) return scale.status();
  Landmarks landmarks;
  for (const auto& [name, value] : document[key].items()) {
    const auto point = parse_point(value, absl::StrCat(file, ": ", key, ".", name));
    if (!point.ok()) return point.status();
    landmarks.points_mm[name] = {*scale * (*point)[0], *scale * (*point)[1], *scale * (*point)[2]};
  }
  // A plan may name them as the file does.
  for (const auto& [name, value] : document[key].items()) {
    const auto understood = understand_landmark_name(name);
    if (understood) landmarks.points_mm.try_emplace(*understood, landmarks.points_mm[name]);
  }
  if (document.contains("axes")) {
    auto axes = parse_axes(document["axes"], file);
    if (!axes.ok()) return axes.status();
    landmarks.axes = *axes;
  }
  return landmarks;
}

std::string write_own_json(const Landmarks& landmarks) {
  nlohmann::ordered_json document = {{"units", "mm"}};
  if (landmarks.axes) {
    document["axes"] = {
        {"left", landmarks.axes->left}, {"up", landmarks.axes->up}, {"forward", landmarks.axes->forward}};
  }
  document["landmarks"] = landmarks.points_mm;
  return document.dump(1) + "\n";
}

}  // namespace

absl::StatusOr<Landmarks> load_landmarks(const std::string& path, v1::ScanUnit scan_unit) {
  const auto [file, key] = split_path(path);
  const std::string ending = ending_of(file);
  if (ending != ".json") {
    const auto list = read_list(file, ending);
    if (!list.ok()) return in_file(file, list.status());
    return take_list(*list, file, scan_unit);
  }
  const auto document = read_json_file(file);
  if (!document.ok()) return document.status();
  if (key.empty() && document->is_object() && document->contains("markups")) {
    const auto list = parse_slicer_markups(*document);
    if (!list.ok()) return in_file(file, list.status());
    return take_list(*list, file, scan_unit);
  }
  return read_own_json(*document, file, key.empty() ? "landmarks" : key, scan_unit);
}

absl::Status save_landmarks(const Landmarks& landmarks, const std::filesystem::path& file) {
  const std::vector<std::pair<std::string, Point>> points(landmarks.points_mm.begin(), landmarks.points_mm.end());
  const std::string ending = absl::AsciiStrToLower(file.extension().string());
  if (absl::EndsWith(absl::AsciiStrToLower(file.string()), ".mrk.json")) {
    return write_text_file(file, write_slicer_markups(points));
  }
  if (ending == ".json") return write_text_file(file, write_own_json(landmarks));
  if (ending == ".fcsv") return write_text_file(file, write_fcsv(points));
  if (ending == ".pp") return write_text_file(file, write_picked_points(points));
  if (ending == ".csv") return write_text_file(file, write_landmark_table(points));
  return absl::InvalidArgumentError(
      absl::StrCat(file.string(), ": '", ending, "' is not one of .json, .mrk.json, .fcsv, .pp, .csv"));
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
