#include "core/planning/registration.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/units.h"
#include "core/planning/landmark_start.h"
#include "core/planning/pose_search.h"
#include "core/planning/reflection.h"

namespace lipofill::planning {
namespace {

constexpr int kSamples = 3000;
constexpr double kReach = 0.010;  // [m]
constexpr AlignmentRule kFromLandmarks{0.015, 0.005, 60, 1e-6};
constexpr AlignmentRule kLast{0.004, 0.004, 60, 1e-7};
constexpr double kGoodMedian = 1e-4;  // [m]; a surface that fits so well is not the mirror image,
constexpr double kGoodShare = 0.97;   // if so much of it is within 1 mm

/// The smaller surface on the larger: what it has has a counterpart more often.
struct Roles {
  const SkinSurface& small;
  const SkinSurface& large;
  bool moving_is_small;

  Roles(const SkinSurface& moving, const SkinSurface& fixed)
      : small(moving.area <= fixed.area ? moving : fixed),
        large(moving.area <= fixed.area ? fixed : moving),
        moving_is_small(moving.area <= fixed.area) {}
  RigidMotion small_to_large(const RigidMotion& motion) const { return moving_is_small ? motion : motion.inverse(); }
};

void fill_figures(const SurfaceSamples& samples, const SkinMatcher& matcher, const RigidMotion& motion,
                  Registration& registration) {
  const Fit fit = measure_fit(samples, matcher, motion, kReach);
  const Certainty certainty = assess_certainty(samples, matcher, motion, kReach);
  registration.overlap = fit.overlap();
  registration.share_within_1_mm = fit.share_within(1e-3);
  registration.median = fit.median();
  registration.inlier_rms = certainty.inlier_rms;
  registration.expected_error = certainty.expected_error;
}

double rise(const RegistrationBounds& bounds, double value) {
  return std::clamp((value - bounds.refused) / (bounds.certain - bounds.refused), 0.0, 1.0);
}

double rate(const Registration& r) {
  return std::min({rise(kOverlapBounds, r.overlap), rise(kShareBounds, r.share_within_1_mm),
                   rise(kErrorBounds, r.expected_error), rise(kRivalBounds, r.rival)});
}

/// The mirror image is clearly nearer: in the median, or where the sides of the face differ.
bool fits_better(const Registration& mirrored, const Registration& own) {
  const bool in_the_median = own.median > kGoodMedian && mirrored.median < 0.6 * own.median &&
                             mirrored.share_within_1_mm > own.share_within_1_mm;
  const bool where_sides_differ = 1.0 - mirrored.share_within_1_mm < 0.5 * (1.0 - own.share_within_1_mm) &&
                                  mirrored.share_within_1_mm > own.share_within_1_mm + 0.03;
  return in_the_median || where_sides_differ;
}

/// Registers the small surface from given placements, best first.
class Refiner {
 public:
  explicit Refiner(const Roles& roles)
      : roles_(roles), samples_(sample_surface(roles.small, kSamples)), matcher_(roles.large) {}

  Registration refine(const RigidMotion& small_to_large, const AlignmentRule& rule, RegistrationStart start) const {
    RigidMotion motion = align_samples(samples_, matcher_, small_to_large, rule);
    motion = align_samples(samples_, matcher_, motion, kLast);
    Registration registration;
    registration.motion = roles_.small_to_large(motion);
    registration.start = start;
    fill_figures(samples_, matcher_, motion, registration);
    registration.confidence = rate(registration);
    return registration;
  }

 private:
  const Roles& roles_;
  SurfaceSamples samples_;
  ExactMatcher matcher_;
};

absl::StatusOr<Registration> register_by_shape(const Roles& roles, const Refiner& refiner, const Unwanted& unwanted) {
  const auto placements = search_poses(roles.small, roles.large, unwanted);
  if (!placements.ok()) return placements.status();
  if (placements->empty()) return Registration{};
  Registration registration = refiner.refine(placements->front().motion, kLast, RegistrationStart::kShape);
  if (placements->size() > 1 && placements->front().score > 0.0) {
    registration.rival = (*placements)[1].score / placements->front().score;
    registration.confidence = rate(registration);
  }
  return registration;
}

/// Finds how well the mirror image of the small surface fits, from wherever it fits best.
absl::StatusOr<Registration> register_mirrored(const Roles& roles, const Unwanted& unwanted) {
  const SkinSurface mirrored = reflect(roles.small, Reflection{Eigen::Vector3d::UnitX(), 0.0});
  const Roles mirrored_roles(roles.moving_is_small ? mirrored : roles.large,
                             roles.moving_is_small ? roles.large : mirrored);
  return register_by_shape(mirrored_roles, Refiner(mirrored_roles), unwanted);
}

}  // namespace

absl::StatusOr<Registration> register_surface(const RegistrationTask& task, const Unwanted& unwanted) {
  const Roles roles(task.moving, task.fixed);
  const Refiner refiner(roles);
  std::optional<Registration> best;
  const auto start = align_landmarks(task.moving_landmarks, task.fixed_landmarks);
  if (!start.ok()) return start.status();
  if (start->has_value()) {
    best = refiner.refine(roles.small_to_large(**start), kFromLandmarks, RegistrationStart::kLandmarks);
  }
  if (!best || best->confidence == 0.0) {
    const auto by_shape = register_by_shape(roles, refiner, unwanted);
    if (!by_shape.ok()) return by_shape.status();
    if (!best || by_shape->confidence > best->confidence) best = *by_shape;
  }
  if (best->median < kGoodMedian && best->share_within_1_mm > kGoodShare) return *best;
  const auto mirrored = register_mirrored(roles, unwanted);
  if (!mirrored.ok()) return mirrored.status();
  best->mirrored_median = mirrored->median;
  best->mirrored_share = mirrored->share_within_1_mm;
  best->is_mirrored = mirrored->overlap > kOverlapBounds.refused && fits_better(*mirrored, *best);
  if (best->is_mirrored) best->confidence = 0.0;
  return *best;
}

Registration measure_in_place(const SkinSurface& moving, const SkinSurface& fixed) {
  const Roles roles(moving, fixed);
  Registration registration;
  registration.start = RegistrationStart::kInPlace;
  fill_figures(sample_surface(roles.small, kSamples), ExactMatcher(roles.large), RigidMotion{}, registration);
  registration.confidence = rate(registration);
  return registration;
}

absl::Status check_registration(const Registration& r, const std::string& name) {
  std::vector<std::string> doubts;
  if (r.is_mirrored) {
    doubts.push_back(absl::StrFormat(
        "its mirror image fits better, %.0f %% within 1 mm and %.2f mm in the median against %.0f %% and %.2f mm: left "
        "and right are swapped",
        100.0 * r.mirrored_share, r.mirrored_median * kMillimetresPerMetre, 100.0 * r.share_within_1_mm,
        r.median * kMillimetresPerMetre));
  }
  if (r.overlap < kOverlapBounds.refused) {
    doubts.push_back(absl::StrFormat("%.0f %% of the smaller surface lie over the other, needed are %.0f %%",
                                     100.0 * r.overlap, 100.0 * kOverlapBounds.refused));
  }
  if (r.share_within_1_mm < kShareBounds.refused) {
    doubts.push_back(absl::StrFormat(
        "of what lies over it %.0f %% fit within 1 mm, needed are %.0f %%: another face, another expression, or "
        "another unit",
        100.0 * r.share_within_1_mm, 100.0 * kShareBounds.refused));
  }
  if (!(r.expected_error < kErrorBounds.refused)) {
    doubts.push_back(
        absl::StrFormat("its place is known to %.2f mm, needed are %.2f mm: too smooth or too small a part",
                        r.expected_error * kMillimetresPerMetre, kErrorBounds.refused * kMillimetresPerMetre));
  }
  if (r.rival > kRivalBounds.refused) {
    doubts.push_back(
        absl::StrFormat("another placement fits %.0f %% as well, at most %.0f %% are accepted; landmarks help",
                        100.0 * r.rival, 100.0 * kRivalBounds.refused));
  }
  if (doubts.empty()) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrFormat("%s cannot be placed on the face with confidence: %s", name, absl::StrJoin(doubts, "; ")));
}

}  // namespace lipofill::planning
