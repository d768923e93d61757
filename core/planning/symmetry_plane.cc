#include "core/planning/symmetry_plane.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "core/base/units.h"
#include "core/planning/face_part.h"
#include "core/planning/skin_matcher.h"
#include "core/planning/surface_samples.h"
#include "core/planning/tukey_weights.h"

namespace lipofill::planning {
namespace {

constexpr int kSamples = 2000;
constexpr int kIterations = 40;
constexpr double kFirstReach = 0.015;  // [m]
constexpr double kLastReach = 0.010;   // [m]
constexpr double kRest = 1e-8;         // [m]
constexpr double kLeastOverlap = 0.5;
constexpr double kMostTurned = 10.0 * kRadiansPerDegree;
constexpr double kMostMoved = 0.010;  // [m]

/// Two unit vectors that span the plane.
std::pair<Eigen::Vector3d, Eigen::Vector3d> find_tangents(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d first = normal.unitOrthogonal();
  return {first, normal.cross(first)};
}

/// Residuals and their rows with respect to (turn along both tangents, offset).
struct Rows {
  std::vector<double> residuals;
  std::vector<Eigen::Vector3d> rows;
};

/// The plane n . (x - c) = d about the middle of the face: turning it there moves it least.
Rows find_rows(const SurfaceSamples& face, const SkinMatcher& skin, const Reflection& plane,
               const Eigen::Vector3d& centre, double reach) {
  const auto [first, second] = find_tangents(plane.normal);
  Rows rows;
  for (Eigen::Index k = 0; k < face.size(); ++k) {
    const Eigen::Vector3d point = face.points.col(k);
    const Eigen::Vector3d image = plane.apply(point);
    const auto match = skin.match(image, plane.turn(face.normals.col(k)), reach);
    if (!match) continue;
    const double height = plane.height(point);
    const auto slope = [&](const Eigen::Vector3d& tangent) {
      return -2.0 * match->normal.dot(tangent.dot(point - centre) * plane.normal + height * tangent);
    };
    rows.residuals.push_back(match->normal.dot(image - match->position));
    rows.rows.emplace_back(slope(first), slope(second), 2.0 * match->normal.dot(plane.normal));
  }
  return rows;
}

/// One step of Gauss-Newton; the largest move of the plane in the face's ball [m].
double improve(const Rows& rows, const Eigen::Vector3d& centre, double radius, Reflection& plane) {
  const double deviation = estimate_deviation(rows.residuals);
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (size_t k = 0; k < rows.rows.size(); ++k) {
    const double w = weigh_residual(rows.residuals[k], deviation);
    matrix += w * rows.rows[k] * rows.rows[k].transpose();
    right -= w * rows.residuals[k] * rows.rows[k];
  }
  const Eigen::Vector3d step = matrix.ldlt().solve(right);
  if (!step.allFinite()) return 0.0;
  const auto [first, second] = find_tangents(plane.normal);
  const double height = plane.offset - plane.normal.dot(centre);
  plane.normal = (plane.normal + step[0] * first + step[1] * second).normalized();
  plane.offset = height + step[2] + plane.normal.dot(centre);
  return step.head<2>().norm() * radius + std::abs(step[2]);
}

double compute_inlier_rms(const Rows& rows) {
  const double deviation = estimate_deviation(rows.residuals);
  double squares = 0.0, weights = 0.0;
  for (const double r : rows.residuals) {
    const double w = weigh_residual(r, deviation);
    squares += w * r * r, weights += w;
  }
  return std::sqrt(squares / weights);
}

absl::Status check_plane(const SymmetryPlane& plane) {
  if (plane.fit.overlap() < kLeastOverlap) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "the sides of the face do not fit each other: %.0f %% of it have a counterpart on the other side, needed are "
        "%.0f %%; a target needs both sides on the scan and landmarks at their places",
        100.0 * plane.fit.overlap(), 100.0 * kLeastOverlap));
  }
  if (plane.turned > kMostTurned || plane.moved > kMostMoved) {
    return absl::FailedPreconditionError(
        absl::StrFormat("the face is symmetric about a plane that is turned by %.1f degrees and moved by %.1f mm "
                        "against the one of its "
                        "landmarks, at most %.0f degrees and %.0f mm are accepted: look at the landmarks",
                        plane.turned / kRadiansPerDegree, plane.moved * kMillimetresPerMetre,
                        kMostTurned / kRadiansPerDegree, kMostMoved * kMillimetresPerMetre));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Reflection> find_landmark_plane(const geometry::Landmarks& landmarks) {
  const auto axes = geometry::estimate_head_axes(landmarks);
  if (!axes.ok()) return axes.status();
  Reflection plane{axes->left, 0.0};
  double n = 0.0;
  for (const auto& [name, position] : landmarks) {
    if (name.ends_with("_right")) continue;
    if (!name.ends_with("_left")) {
      plane.offset += plane.normal.dot(position), n += 1.0;
      continue;
    }
    const auto other = landmarks.find(name.substr(0, name.size() - 5) + "_right");
    if (other == landmarks.end()) continue;
    plane.offset += plane.normal.dot(0.5 * (position + other->second)), n += 1.0;
  }
  plane.offset /= n;
  return plane;
}

absl::StatusOr<SymmetryPlane> find_symmetry_plane(const SkinSurface& skin, const geometry::Landmarks& landmarks,
                                                  const Unwanted& unwanted) {
  const auto start = find_landmark_plane(landmarks);
  if (!start.ok()) return start.status();
  const auto ball = find_face_ball(landmarks);
  const std::vector<int> in_ball = find_triangles_in(skin, *ball);
  if (in_ball.empty()) return absl::FailedPreconditionError("no skin is near the landmarks");
  const SurfaceSamples face = sample_surface(extract_part(skin, in_ball), kSamples);
  const ExactMatcher matcher(skin);
  SymmetryPlane result;
  result.reflection = *start;
  for (int i = 0; i < kIterations; ++i) {
    if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
    const double way = std::min(1.0, 2.0 * i / kIterations);
    const double reach = (1.0 - way) * kFirstReach + way * kLastReach;
    const Rows rows = find_rows(face, matcher, result.reflection, ball->centre, reach);
    if (rows.residuals.size() < 12) return absl::FailedPreconditionError("the sides of the face do not fit each other");
    result.inlier_rms = compute_inlier_rms(rows);
    if (improve(rows, ball->centre, ball->radius, result.reflection) < kRest && way == 1.0) break;
  }
  result.turned = std::acos(std::clamp(start->normal.dot(result.reflection.normal), -1.0, 1.0));
  result.moved = std::abs(start->height(ball->centre) - result.reflection.height(ball->centre));
  SurfaceSamples image = face;
  for (Eigen::Index k = 0; k < face.size(); ++k) {
    image.points.col(k) = result.reflection.apply(face.points.col(k));
    image.normals.col(k) = result.reflection.turn(face.normals.col(k));
  }
  result.fit = measure_fit(image, matcher, RigidMotion{}, kLastReach);
  double squares = 0.0;
  for (const double d : result.fit.distances) squares += d * d;
  result.index = std::sqrt(squares / std::max(1, result.fit.over));
  if (absl::Status good = check_plane(result); !good.ok()) return good;
  return result;
}

}  // namespace lipofill::planning
