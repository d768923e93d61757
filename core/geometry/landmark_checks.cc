#include "core/geometry/landmark_checks.h"

#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/geometry/head_size.h"
#include "core/geometry/skin_border.h"
#include "core/geometry/skin_reach.h"

namespace lipofill::geometry {
namespace {

constexpr char kField[] = "scan_region.landmarks_mm";
constexpr double kSmallestHead = 0.35;  // of an adult's
constexpr double kLargestHead = 3.0;
constexpr double kUsuallySmallestHead = 0.7;
constexpr double kUsuallyLargestHead = 1.4;
constexpr double kFarthestBeyondScan = 0.030;  // [m]
constexpr double kUsuallyFarthest = 0.005;     // [m]
constexpr double kLeastFront = 0.005;          // [m]

std::string field_of(const std::string& landmark) {
  return absl::StrCat(kField, "[\"", landmark, "\"]");
}

const Eigen::Vector3d* find(const Landmarks& landmarks, const std::string& name) {
  const auto found = landmarks.find(name);
  return found == landmarks.end() ? nullptr : &found->second;
}

/// The unit that makes a head of its size of one that is `ratio` times an adult's.
std::string guess_unit(double ratio) {
  if (ratio > 0.05 && ratio < 0.2) return "; it looks like centimetres that are taken for millimetres";
  if (ratio > 0.0005 && ratio < 0.002) return "; it looks like metres that are taken for millimetres";
  if (ratio > 5.0 && ratio < 20.0) return "; it looks like millimetres that are taken for centimetres";
  if (ratio > 500.0 && ratio < 2000.0) return "; it looks like millimetres that are taken for metres";
  return "; check the unit of the scan and of the landmarks";
}

void check_size(const Landmarks& landmarks, FieldViolations& violations, std::vector<std::string>& remarks) {
  const auto typical = find_typical_distance(landmarks);
  if (!typical) return;
  const double ratio = typical->found / typical->usual;
  if (ratio >= kUsuallySmallestHead && ratio <= kUsuallyLargestHead) return;
  const std::string finding = absl::StrFormat("%s to %s is %.1f mm, %.2f of an adult's %.0f mm", typical->from,
                                              typical->to, typical->found * 1e3, ratio, typical->usual * 1e3);
  if (ratio >= kSmallestHead && ratio <= kLargestHead) {
    remarks.push_back(absl::StrCat("The head is of unusual size: ", finding, guess_unit(ratio), "."));
  } else {
    violations.add(kField, absl::StrCat("make no head: ", finding, guess_unit(ratio)));
  }
}

/// Left and right landmarks against the axes, which may be given: a pair that stands the wrong way
/// round.
void check_pairs(const Landmarks& landmarks, const HeadAxes& axes, FieldViolations& violations) {
  for (const char* name : {"exocanthion", "cheilion", "gonion", "zygion", "tragion"}) {
    const Eigen::Vector3d* left = find(landmarks, absl::StrCat(name, "_left"));
    const Eigen::Vector3d* right = find(landmarks, absl::StrCat(name, "_right"));
    if (left == nullptr || right == nullptr) continue;
    const double apart = (*left - *right).dot(axes.left);
    if (apart > 0.0) continue;
    violations.add(
        field_of(absl::StrCat(name, "_left")),
        absl::StrFormat("lies %.1f mm to the subject's right of %s_right: left and right are swapped, or the "
                        "axes are wrong",
                        -apart * 1e3, name));
  }
}

/// The nose and the chin lie in front of the cheekbones and the angles of the jaw; behind them,
/// left and right are swapped or the scan is mirrored: forward follows from left and up.
void check_front(const Landmarks& landmarks, const HeadAxes& axes, FieldViolations& violations) {
  for (const char* side : {"_left", "_right"}) {
    for (const char* rear : {"zygion", "gonion", "tragion"}) {
      const std::string behind = absl::StrCat(rear, side);
      for (const char* front : {"pronasale", "subnasale", "pogonion", "nasion"}) {
        const Eigen::Vector3d* from = find(landmarks, behind);
        const Eigen::Vector3d* to = find(landmarks, front);
        if (from == nullptr || to == nullptr) continue;
        const double ahead = (*to - *from).dot(axes.forward);
        if (ahead >= -kLeastFront) continue;
        violations.add(kField, absl::StrFormat("have %s %.1f mm behind %s, must be in front of it: the names of left "
                                               "and right are swapped, or the scan is mirrored",
                                               front, -ahead * 1e3, behind));
        return;
      }
    }
  }
}

void check_on_scan(const Landmarks& landmarks, const SurfaceMesh& scan, const SurfaceLocator& locator,
                   FieldViolations& violations, std::vector<std::string>& remarks) {
  const BorderFinder borders(scan);
  for (const auto& [name, position] : landmarks) {
    const SurfacePoint nearest = locator.find_nearest(position);
    if (nearest.distance <= kUsuallyFarthest) continue;
    const double mm = nearest.distance * 1e3;
    const bool is_beyond = borders.is_beyond(position, nearest);
    if (is_beyond && nearest.distance <= kFarthestBeyondScan) {
      remarks.push_back(absl::StrFormat("The scan ends %.1f mm before %s.", mm, name));
    } else if (is_beyond) {
      violations.add(field_of(name), absl::StrFormat("lies %.1f mm beyond the end of the scan, must be at most %.0f mm",
                                                     mm, kFarthestBeyondScan * 1e3));
    } else if (nearest.distance > kFarthestFromSkin) {
      violations.add(field_of(name),
                     absl::StrFormat("lies %.1f mm from the surface of the scan, must be at most %.0f mm", mm,
                                     kFarthestFromSkin * 1e3));
    } else {
      remarks.push_back(absl::StrFormat("%s lies %.1f mm from the surface of the scan.", name, mm));
    }
  }
}

void add_eye(const Landmarks& landmarks, const HeadAxes& axes, const std::string& side, std::vector<Obstacle>& found) {
  const Eigen::Vector3d* corner = find(landmarks, "exocanthion" + side);
  const Eigen::Vector3d* root = find(landmarks, "nasion");
  if (corner == nullptr || root == nullptr) return;
  const Eigen::Vector3d inner = 0.36 * *corner + 0.64 * *root;
  const double opening = 0.12 * (*corner - inner).norm();
  for (const double t : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
    const double height = opening * (1.0 - std::abs(2.0 * t - 1.0));
    for (const double up : {-height, height}) {
      found.push_back({"the eye", (1.0 - t) * *corner + t * inner + up * axes.up});
    }
  }
}

void add_mouth(const Landmarks& landmarks, const HeadAxes& axes, const std::string& side,
               std::vector<Obstacle>& found) {
  const Eigen::Vector3d* corner = find(landmarks, "cheilion" + side);
  const Eigen::Vector3d* nose = find(landmarks, "subnasale");
  if (corner == nullptr || nose == nullptr) return;
  // The middle of the mouth stands as far forward as the base of the nose, at the height of its
  // corner.
  const Eigen::Vector3d middle = *nose + (*corner - *nose).dot(axes.up) * axes.up;
  for (const double t : {0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0}) {
    found.push_back({"the mouth", (1.0 - t) * *corner + t * middle});
  }
}

void add_ear(const Landmarks& landmarks, const HeadAxes& axes, const std::string& side, std::vector<Obstacle>& found) {
  const Eigen::Vector3d* tragion = find(landmarks, "tragion" + side);
  if (tragion == nullptr) return;
  for (const double up : {-0.025, -0.0125, 0.0, 0.0125, 0.025}) {
    found.push_back({"the ear", *tragion + up * axes.up - 0.006 * axes.forward});
  }
}

}  // namespace

absl::Status check_finite(const Landmarks& landmarks) {
  FieldViolations violations;
  for (const auto& [name, position] : landmarks) {
    if (!position.allFinite()) violations.add(field_of(name), "is not a finite position");
  }
  return violations.to_status();
}

absl::Status check_landmarks(const Landmarks& landmarks, const HeadAxes* axes, const SurfaceMesh& scan,
                             const SurfaceLocator& locator, std::vector<std::string>& remarks) {
  FieldViolations violations;
  check_size(landmarks, violations, remarks);
  if (axes != nullptr) {
    check_pairs(landmarks, *axes, violations);
    check_front(landmarks, *axes, violations);
  }
  check_on_scan(landmarks, scan, locator, violations, remarks);
  return violations.to_status();
}

std::vector<Obstacle> find_face_obstacles(const Landmarks& landmarks, const HeadAxes& axes) {
  std::vector<Obstacle> found;
  for (const std::string side : {"_left", "_right"}) {
    add_eye(landmarks, axes, side, found);
    add_mouth(landmarks, axes, side, found);
    add_ear(landmarks, axes, side, found);
  }
  return found;
}

}  // namespace lipofill::geometry
