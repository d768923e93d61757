#include "core/planning/proposal_case.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/units.h"
#include "core/planning/comparison.h"

namespace lipofill::planning {
namespace {

using Eigen::Index;

/// The target is searched this far around the skin [m].
constexpr double kReach = 40e-3;
/// Points farther from it have no target opposite [m].
constexpr double kFar = 30e-3;
/// So much of the skin must have a target opposite.
constexpr double kLeastOpposite = 0.3;
/// A target no farther than this is the skin itself [m].
constexpr double kSame = 5e-6;
/// A target of which half lies farther from the skin is another face, or in another frame [m]
/// (assumed).
constexpr double kOtherFace = 12e-3;
/// Hollows narrower than this are noise of a scan [m].
constexpr double kSmoothing = 4e-3;

double in_mm(double length) {
  return length * kMillimetresPerMetre;
}

/// Says why nothing can be proposed, with what is known of the distances.
absl::Status nothing_missing(const Eigen::VectorXd& distance, double min_deficit) {
  double sum = 0.0, least = kFar;
  Index n = 0;
  for (const double d : distance) {
    if (std::isnan(d)) continue;
    sum += d;
    least = std::min(least, d);
    ++n;
  }
  const double mean = n > 0 ? sum / static_cast<double>(n) : 0.0;
  if (least > -kSame && std::abs(mean) < kSame) {
    return absl::FailedPreconditionError("nothing is missing: the target is the skin as it is");
  }
  const std::string where =
      least >= 0.0 ? std::string("everywhere below the skin")
                   : absl::StrFormat("outside the skin by %.2f mm at most, in places narrower than the tissue shows",
                                     -in_mm(least));
  return absl::FailedPreconditionError(
      absl::StrFormat("nothing is missing: the target lies %s, and %.2f mm %s it on average; fat lifts skin, so that a "
                      "proposal needs a target at least %.2f mm outside of it",
                      where, std::abs(in_mm(mean)), mean > 0.0 ? "below" : "above", in_mm(min_deficit)));
}

/// Refuses a target that half of the skin is too far from.
absl::Status check_same_face(const Eigen::VectorXd& distance) {
  std::vector<double> known;
  std::copy_if(distance.begin(), distance.end(), std::back_inserter(known), [](double d) { return !std::isnan(d); });
  const double median = geometry::compute_distance_statistics(known).median;
  if (median <= kOtherFace) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrFormat("half of the skin lies more than %.1f mm from the target, %.1f mm is the most that is taken for "
                      "the same face: register the target first (lipofill target), or choose the target of this face",
                      in_mm(median), in_mm(kOtherFace)));
}

}  // namespace

std::vector<double> ProposalCase::of_lacking(const Eigen::VectorXd& distances) const {
  std::vector<double> chosen;
  for (Index k = 0; k < distances.size(); ++k) {
    if (is_lacking[static_cast<size_t>(k)]) chosen.push_back(distances[k]);
  }
  return chosen;
}

double ProposalCase::lacking_area() const {
  double area = 0.0;
  for (Index k = 0; k < points.n(); ++k) {
    if (is_lacking[static_cast<size_t>(k)]) area += points.area[k];
  }
  return area;
}

double ProposalCase::rms(const Eigen::VectorXd& distances) const {
  return geometry::compute_distance_statistics(of_lacking(distances)).rms;
}

double ProposalCase::p95(const Eigen::VectorXd& distances) const {
  return geometry::compute_distance_statistics(of_lacking(distances)).p95;
}

absl::StatusOr<Closeness> ProposalCase::compare(const Eigen::Matrix3Xd& displacement, const Unwanted& unwanted) const {
  geometry::SurfaceMesh moved = points.rest;
  moved.points += points.gather(displacement);
  std::vector<bool> left_out = is_lacking;
  left_out.flip();
  moved = geometry::extract_triangles(moved, find_triangles_without(moved, left_out)).mesh;
  Closeness closeness;
  closeness.skin_vertices = moved.n_vertices();
  if (moved.triangles.empty()) return closeness;
  auto found = geometry::compute_patch_distance(moved, target->surface(), unwanted);
  if (!found.ok()) return found.status();
  closeness.skin_to_target = found->patch_to_target_statistics;
  closeness.target_to_skin = found->target_to_patch_statistics;
  const auto volume = geometry::compute_volume_between(moved, target->surface(), unwanted);
  if (!volume.ok()) return volume.status();
  closeness.volume = *volume;
  return closeness;
}

absl::StatusOr<ProposalCase> make_proposal_case(std::shared_ptr<const model::FaceModel> model,
                                                const geometry::SurfaceMesh& target, double min_deficit) {
  ProposalCase made;
  made.model = std::move(model);
  made.points = make_skin_points(*made.model);
  if (made.points.rest.triangles.empty())
    return absl::FailedPreconditionError("the patch of the model has no triangle");
  made.target = std::make_unique<TargetDistance>(target, made.points.rest, kReach);
  const auto no_overlap = [](double share) {
    return absl::FailedPreconditionError(
        absl::StrFormat("the target lies opposite to %.0f %% of the skin of the model, at least %.0f %% are needed: it "
                        "has to be in the "
                        "frame of the scan, and to cover the region",
                        100.0 * share, 100.0 * kLeastOpposite));
  };
  if (made.target->is_empty()) return no_overlap(0.0);
  made.distance.setConstant(made.points.n(), std::numeric_limits<double>::quiet_NaN());
  double opposite = 0.0;
  for (Index k = 0; k < made.points.n(); ++k) {
    const TargetSide side = made.target->at(made.points.rest.points.col(k));
    if (side.is_off || std::abs(side.distance) > kFar) continue;
    made.distance[k] = side.distance;
    opposite += made.points.area[k];
  }
  if (opposite < kLeastOpposite * made.points.area.sum()) return no_overlap(opposite / made.points.area.sum());
  if (absl::Status same = check_same_face(made.distance); !same.ok()) return same;
  made.deficit = smooth_deficit(*made.model, *made.target, kSmoothing);
  made.is_lacking.assign(static_cast<size_t>(made.points.n()), false);
  for (Index k = 0; k < made.points.n(); ++k) {
    const auto index = static_cast<size_t>(k);
    const geometry::ChartPoint& place = made.points.place[index];
    if (std::isnan(made.distance[k]) || made.deficit.at(place.xi, place.eta) < min_deficit) continue;
    made.is_lacking[index] = true;
    made.missing += made.points.area[k] * std::max(0.0, -made.distance[k]);
  }
  if (!(made.missing > 0.0)) return nothing_missing(made.distance, min_deficit);
  return made;
}

}  // namespace lipofill::planning
