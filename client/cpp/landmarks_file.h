#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

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
};

/// Reads landmarks from JSON: the object "landmarks" of name to [x, y, z], or the object named
/// after a '#' in the path (case.json#landmarks_before); optionally "axes" with "left", "up" and
/// "forward". "units" in the file ("mm", "cm", "m") says in what the numbers are; without it they
/// are in the unit of the scan. INVALID_ARGUMENT, naming the file and the entry, for anything else.
/// Checked by tests/unit/client/landmarks_file_test.cc.
absl::StatusOr<Landmarks> load_landmarks(const std::string& path, v1::ScanUnit scan_unit);

/// Puts landmarks into a region; its own axes stay where it has them.
void set_landmarks(const Landmarks& landmarks, v1::ScanRegion* region);

/// Finds which way is up in the scan's frame, by the axes or, without them, from the landmarks of
/// the midline; none when neither tells.
std::optional<Point> up_of(const v1::ScanRegion& region);

}  // namespace lipofill::client
