#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

using Point = std::array<double, 3>;

/// Landmarks as a file of another program has them, with x to the left and y to the back where the
/// file tells (LPS): of a file in RAS x and y are turned round.
struct LandmarkList {
  std::vector<std::pair<std::string, Point>> points;  ///< in the order of the file, in its unit
  std::optional<double> mm_per_unit;                  ///< where the file tells
  bool was_ras = false;
  size_t passed_over = 0;  ///< points that are not placed, not active or not named
};

/// Markups of 3D Slicer (.mrk.json): the control points of all markups of the file.
absl::StatusOr<LandmarkList> parse_slicer_markups(const nlohmann::json& document);

/// Fiducials of 3D Slicer (.fcsv). Without a coordinate system they are in RAS, as old versions
/// wrote them.
absl::StatusOr<LandmarkList> parse_fcsv(std::string_view text);

/// Points picked in MeshLab (.pp).
absl::StatusOr<LandmarkList> parse_picked_points(std::string_view text);

/// A table of names and coordinates (.csv, .tsv, .txt): a comma, semicolon or tab between columns,
/// with or without a line of their names. Names of columns may give the unit ("x_mm") and the
/// frame: r, a, s or l, p, s as 3D Slicer exports them. With semicolons and tabs a comma may be the
/// decimal point.
absl::StatusOr<LandmarkList> parse_landmark_table(std::string_view text);

/// INVALID_ARGUMENT saying where and what for anything else, from each. Nothing is thrown.
/// Checked by tests/unit/client/landmark_formats_test.cc and tests/fuzz/landmarks_fuzzer.cc.

/// The same landmarks as such files, in millimetres and LPS.
std::string write_slicer_markups(const std::vector<std::pair<std::string, Point>>& points);
std::string write_fcsv(const std::vector<std::pair<std::string, Point>>& points);
std::string write_picked_points(const std::vector<std::pair<std::string, Point>>& points);
std::string write_landmark_table(const std::vector<std::pair<std::string, Point>>& points);

}  // namespace lipofill::client
