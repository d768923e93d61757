#include "core/geometry/head_axes.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/units.h"

namespace lipofill::geometry {
namespace {

constexpr double kShortestUsefulLength = 1e-3;  // [m]

std::optional<Eigen::Vector3d> sum_of_left_minus_right(const Landmarks& landmarks) {
  constexpr std::array kPaired = {"exocanthion", "cheilion", "gonion", "zygion", "tragion"};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const char* name : kPaired) {
    const auto left = landmarks.find(std::string(name) + "_left");
    const auto right = landmarks.find(std::string(name) + "_right");
    if (left != landmarks.end() && right != landmarks.end()) sum += left->second - right->second;
  }
  if (!(sum.norm() > kShortestUsefulLength)) return std::nullopt;
  return sum;
}

/// A line up the midline of the face, and how far it leans forward of the head's up [rad]: mean of
/// two scans whose axes are known (menton 1.0 and 4.6 degrees, pogonion -3.8 and -3.4 degrees).
struct Profile {
  Eigen::Vector3d chin_to_nasion;
  double forward_lean = 0.0;
};

std::optional<Profile> find_profile(const Landmarks& landmarks) {
  const auto nasion = landmarks.find("nasion");
  if (nasion == landmarks.end()) return std::nullopt;
  const auto menton = landmarks.find("menton");
  if (menton != landmarks.end()) return Profile{nasion->second - menton->second, 2.8 * kRadiansPerDegree};
  const auto pogonion = landmarks.find("pogonion");
  if (pogonion != landmarks.end()) return Profile{nasion->second - pogonion->second, -3.6 * kRadiansPerDegree};
  return std::nullopt;
}

}  // namespace

absl::StatusOr<HeadAxes> estimate_head_axes(const Landmarks& landmarks) {
  const auto across = sum_of_left_minus_right(landmarks);
  if (!across) {
    return absl::FailedPreconditionError(
        "head axes need a pair of landmarks on both sides, apart from each other: exocanthion, cheilion, gonion, "
        "zygion or "
        "tragion with _left and _right; none is there");
  }
  const auto profile = find_profile(landmarks);
  if (!profile) {
    return absl::FailedPreconditionError("head axes need the landmarks nasion and menton (or pogonion)");
  }
  HeadAxes axes;
  axes.left = across->normalized();
  const Eigen::Vector3d raised = profile->chin_to_nasion - axes.left * axes.left.dot(profile->chin_to_nasion);
  if (!(raised.norm() > kShortestUsefulLength)) {
    return absl::FailedPreconditionError("head axes need nasion and menton apart from each other across the midline");
  }
  const Eigen::Vector3d line = raised.normalized();
  const Eigen::Vector3d ahead = axes.left.cross(line);
  axes.up = std::cos(profile->forward_lean) * line - std::sin(profile->forward_lean) * ahead;
  axes.forward = axes.left.cross(axes.up);
  return axes;
}

}  // namespace lipofill::geometry
