#include "core/planning/alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/planning/tukey_weights.h"

namespace lipofill::planning {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kCorrelationLength = 0.015;  // [m]
constexpr double kLeastRms = 5e-5;            // [m]
constexpr size_t kFewestPairs = 12;
constexpr double kDeviationsOfReach = 1.0 / 6.0;

/// A sample, brought by the motion, and its distance from the tangent plane of its place.
struct Pair {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
  double residual;
};

std::vector<Pair> find_pairs(const SurfaceSamples& moving, const SkinMatcher& fixed, const RigidMotion& motion,
                             double reach) {
  std::vector<Pair> pairs;
  pairs.reserve(static_cast<size_t>(moving.size()));
  for (Eigen::Index k = 0; k < moving.size(); ++k) {
    const Eigen::Vector3d point = motion.apply(moving.points.col(k));
    const auto match = fixed.match(point, motion.rotation * moving.normals.col(k), reach);
    if (match) pairs.push_back({point, match->normal, match->normal.dot(point - match->position)});
  }
  return pairs;
}

struct System {
  Matrix6d matrix = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double weight = 0.0;
  double squares = 0.0;  ///< weighted
};

/// Rows of r with respect to (turn about the centre, move).
System assemble_system(const std::vector<Pair>& pairs, double reach) {
  System system;
  for (const Pair& pair : pairs) system.centre += pair.point / static_cast<double>(pairs.size());
  std::vector<double> residuals;
  for (const Pair& pair : pairs) residuals.push_back(pair.residual);
  const double deviation = std::min(estimate_deviation(std::move(residuals)), kDeviationsOfReach * reach);
  for (const Pair& pair : pairs) {
    const double w = weigh_residual(pair.residual, deviation);
    if (w == 0.0) continue;
    Vector6d row;
    row.head<3>() = (pair.point - system.centre).cross(pair.normal);
    row.tail<3>() = pair.normal;
    system.matrix += w * row * row.transpose();
    system.right -= w * pair.residual * row;
    system.weight += w;
    system.squares += w * pair.residual * pair.residual;
  }
  return system;
}

}  // namespace

RigidMotion align_samples(const SurfaceSamples& moving, const SkinMatcher& fixed, const RigidMotion& start,
                          const AlignmentRule& rule) {
  RigidMotion motion = start;
  for (int i = 0; i < rule.iterations; ++i) {
    const double way = std::min(1.0, 2.0 * i / rule.iterations);
    const double reach = (1.0 - way) * rule.first_reach + way * rule.last_reach;
    const std::vector<Pair> pairs = find_pairs(moving, fixed, motion, reach);
    if (pairs.size() < kFewestPairs) return motion;
    System system = assemble_system(pairs, reach);
    // Directions that nothing determines stay as they are: a hair of Tikhonov, in lengths of the
    // samples' extent.
    double extent = 0.0;
    for (const Pair& pair : pairs) extent = std::max(extent, (pair.point - system.centre).norm());
    system.matrix.diagonal().head<3>().array() += 1e-9 * system.weight * extent * extent;
    system.matrix.diagonal().tail<3>().array() += 1e-9 * system.weight;
    const Vector6d step = system.matrix.ldlt().solve(system.right);
    if (!step.allFinite()) return motion;
    const RigidMotion change = turn_about(system.centre, step.head<3>(), step.tail<3>());
    motion = change.after(motion);
    if (reach <= rule.last_reach && step.head<3>().norm() * extent + step.tail<3>().norm() < rule.rest) break;
  }
  return motion;
}

double Fit::share_within(double distance) const {
  if (distances.empty()) return 0.0;
  const auto end = std::lower_bound(distances.begin(), distances.end(), distance);
  return static_cast<double>(end - distances.begin()) / static_cast<double>(distances.size());
}

Fit measure_fit(const SurfaceSamples& moving, const SkinMatcher& fixed, const RigidMotion& motion, double reach) {
  Fit fit;
  fit.samples = static_cast<int>(moving.size());
  for (Eigen::Index k = 0; k < moving.size(); ++k) {
    const auto match = fixed.match(motion.apply(moving.points.col(k)), motion.rotation * moving.normals.col(k), reach);
    if (match) fit.distances.push_back(match->distance);
  }
  fit.over = static_cast<int>(fit.distances.size());
  std::sort(fit.distances.begin(), fit.distances.end());
  return fit;
}

Certainty assess_certainty(const SurfaceSamples& moving, const SkinMatcher& fixed, const RigidMotion& motion,
                           double reach) {
  Certainty certainty{0.0, std::numeric_limits<double>::infinity()};
  const std::vector<Pair> pairs = find_pairs(moving, fixed, motion, reach);
  if (pairs.size() < kFewestPairs) return certainty;
  const System system = assemble_system(pairs, reach);
  if (system.weight <= 0.0) return certainty;
  certainty.inlier_rms = std::sqrt(system.squares / system.weight);
  const double area_each = moving.spacing * moving.spacing;
  const double independent = system.weight * std::min(1.0, area_each / (kCorrelationLength * kCorrelationLength));
  const Eigen::LDLT<Matrix6d> factor(system.matrix);
  if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-12)) return certainty;
  const double rms = std::max(kLeastRms, certainty.inlier_rms);
  const Matrix6d covariance = rms * rms * system.weight / independent * factor.solve(Matrix6d::Identity());
  double largest = 0.0;
  for (Eigen::Index k = 0; k < moving.size(); ++k) {
    const Eigen::Vector3d arm = motion.apply(moving.points.col(k)) - system.centre;
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian << 0.0, arm[2], -arm[1], 1, 0, 0,  //
        -arm[2], 0.0, arm[0], 0, 1, 0,          //
        arm[1], -arm[0], 0.0, 0, 0, 1;
    largest = std::max(largest, (jacobian * covariance * jacobian.transpose()).trace());
  }
  certainty.expected_error = std::sqrt(largest);
  return certainty;
}

}  // namespace lipofill::planning
