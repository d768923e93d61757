#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lipofill/v1/geometry.pb.h"
#include "lipofill/v1/plan.pb.h"

namespace lipofill::client {

using Point = std::array<double, 3>;

/// Unit vectors of the head in the scan's frame; left is the subject's own.
struct Axes {
  Point left{};
  Point up{};
  Point forward{};
};

struct Landmarks {
  std::map<std::string, Point> points_mm;
  std::optional<Axes> axes;
  std::vector<std::string> remarks;  ///< what was made of the file, a sentence each
};

/// Reads landmarks from JSON: the object "landmarks" of name to [x, y, z], or the object named
/// after a '#' in the path (case.json#landmarks_before), where no file has the '#' in its own name;
/// optionally "axes" with "left", "up" and "forward". Also from markups and fiducials of 3D Slicer
/// (.mrk.json, .fcsv), points picked in MeshLab (.pp) and tables (.csv, .tsv, .txt), see
/// landmark_formats.h. A unit that the file tells ("units": "mm", "cm", "m") holds; without it
/// numbers are in the unit of the scan. Names of common schemes get the daemon's names
/// (landmark_names.h); in the project's own JSON the others stay beside them. INVALID_ARGUMENT,
/// naming the file and the entry, for anything else. Checked by
/// tests/unit/client/landmarks_file_test.cc.
absl::StatusOr<Landmarks> load_landmarks(const std::string& path, v1::ScanUnit scan_unit);

/// Writes landmarks in millimetres in the format that the ending names: .json, .mrk.json, .fcsv,
/// .pp, .csv. INVALID_ARGUMENT for another one. Axes go into .json alone.
absl::Status save_landmarks(const Landmarks& landmarks, const std::filesystem::path& file);

/// Puts landmarks into a region; its own axes stay where it has them.
void set_landmarks(const Landmarks& landmarks, v1::ScanRegion* region);

/// Finds which way is up in the scan's frame, by the axes or, without them, from the landmarks of
/// the midline; none when neither tells.
std::optional<Point> up_of(const v1::ScanRegion& region);

}  // namespace lipofill::client
