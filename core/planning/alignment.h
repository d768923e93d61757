#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/planning/rigid_motion.h"
#include "core/planning/skin_matcher.h"
#include "core/planning/surface_samples.h"

namespace lipofill::planning {

/// The rule says how far to look for what belongs together, and how long to go on.
struct AlignmentRule {
  double first_reach = 0.02;  ///< [m]
  double last_reach = 0.01;   ///< [m]; the reach shrinks evenly to it over the first half of the iterations
  int iterations = 30;        ///< at most
  double rest = 1e-7;         ///< it ends when no point moves farther in an iteration [m]
};

/// Moves samples onto a skin by iterative closest points, point to plane, from a start.
///
///     min over R, t  of  sum w(r_k) r_k^2,   r_k = n_k . (R p_k + t - q_k)
///
/// q_k, n_k: place and normal that belong to sample k. w is Tukey's biweight with its scale from
/// the median of |r|, at least 0.05 mm and at most a sixth of the reach: what is more than 4.7
/// robust standard deviations away, as tissue that was operated on, counts for nothing (trimmed
/// outliers). Each iteration solves the linear 6 x 6 system about the samples' centre (Chen &
/// Medioni 1992). Deterministic. Checked by tests/unit/planning/alignment_test.cc.
RigidMotion align_samples(const SurfaceSamples& moving, const SkinMatcher& fixed, const RigidMotion& start,
                          const AlignmentRule& rule);

/// The fit tells how well samples lie on a skin.
struct Fit {
  int samples = 0;                ///< all that were asked for
  int over = 0;                   ///< of these lie over the skin: a place within the reach belongs to them
  std::vector<double> distances;  ///< of those from the skin [m], ascending

  double overlap() const { return samples == 0 ? 0.0 : static_cast<double>(over) / samples; }
  /// Share of those over the skin that are nearer than this.
  double share_within(double distance) const;
  /// The same, of all samples.
  double score(double distance) const { return overlap() * share_within(distance); }
  double median() const { return distances.empty() ? 0.0 : distances[(distances.size() - 1) / 2]; }
};

Fit measure_fit(const SurfaceSamples& moving, const SkinMatcher& fixed, const RigidMotion& motion, double reach);

/// The certainty tells what the residuals leave undetermined. With the normal matrix N of the
/// system above over the samples that count, s their root mean square and n_eff of n of them
/// independent (skin is smooth: one for every (15 mm)^2),
///
///     C = s^2 (n / n_eff) N^-1,     e(p)^2 = trace(J_p C J_p^T)
///
/// is the variance of where point p comes to.
struct Certainty {
  double inlier_rms = 0.0;      ///< s [m]
  double expected_error = 0.0;  ///< largest e(p) over the samples [m]; infinite where N is singular
};

Certainty assess_certainty(const SurfaceSamples& moving, const SkinMatcher& fixed, const RigidMotion& motion,
                           double reach);

}  // namespace lipofill::planning
