#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lipofill::planning {

/// x -> R x + t, R a rotation and t in metres.
struct RigidMotion {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d apply(const Eigen::Vector3d& point) const { return rotation * point + translation; }
  RigidMotion inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
  /// This one after `first`.
  RigidMotion after(const RigidMotion& first) const {
    return {rotation * first.rotation, rotation * first.translation + translation};
  }
};

/// Turns by a vector (its direction the axis, its length the angle [rad]) about a point, then
/// moves.
inline RigidMotion turn_about(const Eigen::Vector3d& centre, const Eigen::Vector3d& turn, const Eigen::Vector3d& move) {
  const double angle = turn.norm();
  RigidMotion motion;
  if (angle > 0.0) motion.rotation = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  motion.translation = centre - motion.rotation * centre + move;
  return motion;
}

/// Root of the mean square of the distance between where two motions bring points [m].
inline double compare_motions(const RigidMotion& a, const RigidMotion& b, const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd apart = ((a.rotation - b.rotation) * points).colwise() + (a.translation - b.translation);
  return std::sqrt(apart.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, points.cols())));
}

}  // namespace lipofill::planning
