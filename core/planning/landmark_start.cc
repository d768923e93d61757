#include "core/planning/landmark_start.h"

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/units.h"

namespace lipofill::planning {
namespace {

constexpr double kWorthLooking = 0.005;  // [m]; landmarks that fit better are not swapped
constexpr double kLeastSpread = 0.005;   // [m]

/// Points of the same names, a column each.
struct CommonPoints {
  Eigen::Matrix3Xd moving;
  Eigen::Matrix3Xd fixed;
};

CommonPoints find_common(const geometry::Landmarks& moving, const geometry::Landmarks& fixed) {
  CommonPoints common;
  for (const auto& [name, position] : moving) {
    const auto other = fixed.find(name);
    if (other == fixed.end()) continue;
    const Eigen::Index n = common.moving.cols();
    common.moving.conservativeResize(3, n + 1);
    common.fixed.conservativeResize(3, n + 1);
    common.moving.col(n) = position;
    common.fixed.col(n) = other->second;
  }
  return common;
}

geometry::Landmarks exchange_sides(const geometry::Landmarks& landmarks) {
  geometry::Landmarks exchanged;
  for (const auto& [name, position] : landmarks) {
    std::string other = name;
    if (absl::EndsWith(name, "_left")) other = absl::StrCat(name.substr(0, name.size() - 5), "_right");
    if (absl::EndsWith(name, "_right")) other = absl::StrCat(name.substr(0, name.size() - 6), "_left");
    exchanged[other] = position;
  }
  return exchanged;
}

std::optional<RigidMotion> fit_motion(const CommonPoints& common) {
  if (common.moving.cols() < 3) return std::nullopt;
  const Eigen::Vector3d from = common.moving.rowwise().mean();
  const Eigen::Vector3d to = common.fixed.rowwise().mean();
  const Eigen::Matrix3d product = (common.fixed.colwise() - to) * (common.moving.colwise() - from).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > kLeastSpread * kLeastSpread)) return std::nullopt;
  Eigen::Vector3d signs(1.0, 1.0, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0);
  RigidMotion motion;
  motion.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  motion.translation = to - motion.rotation * from;
  return motion;
}

double compute_rms(const CommonPoints& common, const RigidMotion& motion) {
  const Eigen::Matrix3Xd apart = ((motion.rotation * common.moving).colwise() + motion.translation) - common.fixed;
  return std::sqrt(apart.squaredNorm() / static_cast<double>(apart.cols()));
}

}  // namespace

absl::StatusOr<std::optional<RigidMotion>> align_landmarks(const geometry::Landmarks& moving,
                                                           const geometry::Landmarks& fixed) {
  const CommonPoints common = find_common(moving, fixed);
  const std::optional<RigidMotion> motion = fit_motion(common);
  if (!motion) return motion;
  const double rms = compute_rms(common, *motion);
  if (rms < kWorthLooking) return motion;
  const CommonPoints exchanged = find_common(exchange_sides(moving), fixed);
  const std::optional<RigidMotion> other = fit_motion(exchanged);
  if (!other || compute_rms(exchanged, *other) > 0.5 * rms) return motion;
  return absl::InvalidArgumentError(absl::StrFormat(
      "the landmarks of the two surfaces are %.1f mm apart, but %.1f mm with left and right exchanged: on one of the "
      "surfaces left and right are swapped; left is the subject's own",
      rms * kMillimetresPerMetre, compute_rms(exchanged, *other) * kMillimetresPerMetre));
}

}  // namespace lipofill::planning
