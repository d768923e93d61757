#include "core/planning/proposal_remainder.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "absl/strings/str_format.h"
#include "core/base/units.h"

namespace lipofill::planning {
namespace {

using Eigen::Index;

/// Skin that a zone moves by less than this share of where it moves most is out of its reach.
constexpr double kLeastReach = 0.05;
/// Parts of less are not told of [m3].
constexpr double kToldVolume = 0.02e-6;

/// The zone that moves a point most, by shares of its largest movement; -1 where none reaches it.
int find_mover(const Eigen::MatrixXd& reach, const Eigen::VectorXd& largest, Index point) {
  int mover = -1;
  double most = kLeastReach;
  for (Index z = 0; z < reach.cols(); ++z) {
    const double share = largest[z] > 0.0 ? std::abs(reach(point, z)) / largest[z] : 0.0;
    if (share < most) continue;
    most = share;
    mover = static_cast<int>(z);
  }
  return mover;
}

Eigen::VectorXd largest_of(const Eigen::MatrixXd& reach) {
  return reach.cwiseAbs().colwise().maxCoeff().transpose();
}

const char* name_of(Bound bound) {
  switch (bound) {
    case Bound::kMinZone:
      return "the least volume of the zone";
    case Bound::kMaxZone:
      return "the largest volume of the zone";
    case Bound::kMaxTotal:
      return "the largest total volume";
    case Bound::kMaxPressure:
      return "the largest pressure";
    case Bound::kMaxLift:
      return "the largest lift of the skin";
    case Bound::kPath:
      return "the tissue, which takes no more fat there,";
    case Bound::kNone:
      break;
  }
  return "nothing";
}

}  // namespace

double share_within_reach(const ProposalCase& face, const FittedVolumes& fitted) {
  const Eigen::VectorXd largest = largest_of(fitted.reach);
  double within = 0.0;
  for (Index k = 0; k < face.points.n(); ++k) {
    if (!face.is_lacking[static_cast<size_t>(k)] || find_mover(fitted.reach, largest, k) < 0) continue;
    within += face.points.area[k] * std::max(0.0, -face.distance[k]);
  }
  return within / face.missing;
}

std::vector<Remainder> explain_remainders(const ProposalCase& face, const std::vector<SoughtZone>& zones,
                                          const FittedVolumes& fitted) {
  const Eigen::VectorXd largest = largest_of(fitted.reach);
  std::map<std::pair<int, Cause>, Remainder> parts;
  std::map<std::pair<int, Cause>, double> areas;
  for (Index k = 0; k < face.points.n(); ++k) {
    if (std::isnan(face.distance[k])) continue;
    const double left = fitted.distance[k];
    const int mover = find_mover(fitted.reach, largest, k);
    Cause cause = Cause::kStiffness;
    Bound bound = Bound::kNone;
    if (face.distance[k] > 0.0 && left > 0.0) {
      cause = Cause::kAboveTarget;
    } else if (mover < 0) {
      cause = Cause::kOutOfReach;
    } else {
      bound = fitted.bound[static_cast<size_t>(mover)];
      // A least volume holds skin too far out, all others hold it back.
      const bool is_least = bound == Bound::kMinZone;
      const bool holds = is_least ? left > 0.0 && zones[static_cast<size_t>(mover)].bounds.low > 0.0 : left < 0.0;
      if (bound == Bound::kNone || !holds) {
        bound = Bound::kNone;
      } else {
        cause = Cause::kBound;
      }
    }
    const auto key = std::pair(mover, cause);
    Remainder& part = parts[key];
    part.zone = mover < 0 ? "" : zones[static_cast<size_t>(mover)].name;
    part.cause = cause;
    part.bound = bound;
    (left < 0.0 ? part.volume.deficit : part.volume.excess) += face.points.area[k] * std::abs(left);
    part.rms += face.points.area[k] * left * left;
    areas[key] += face.points.area[k];
  }
  std::vector<Remainder> told;
  for (auto& [key, part] : parts) {
    if (part.volume.deficit + part.volume.excess < kToldVolume) continue;
    part.rms = std::sqrt(part.rms / areas[key]);
    told.push_back(part);
  }
  std::stable_sort(told.begin(), told.end(), [](const Remainder& a, const Remainder& b) {
    return a.volume.deficit + a.volume.excess > b.volume.deficit + b.volume.excess;
  });
  return told;
}

std::string describe_remainder(const Remainder& remainder) {
  const double deficit = remainder.volume.deficit / kCubicMetresPerMillilitre;
  const double excess = remainder.volume.excess / kCubicMetresPerMillilitre;
  const double rms = remainder.rms * kMillimetresPerMetre;
  const std::string where = remainder.zone.empty() ? "beside all zones" : "over zone '" + remainder.zone + "'";
  switch (remainder.cause) {
    case Cause::kBound:
      return absl::StrFormat("%s %.2f mL are %s (%.2f mm rms): %s holds the volume", where, deficit + excess,
                             remainder.bound == Bound::kMinZone ? "too many" : "missing", rms,
                             name_of(remainder.bound));
    case Cause::kOutOfReach:
      return absl::StrFormat("%s %.2f mL are missing (%.2f mm rms): no zone lies under this skin", where, deficit, rms);
    case Cause::kStiffness:
      return absl::StrFormat(
          "%s %.2f mL are missing and %.2f mL are too many (%.2f mm rms): the tissue spreads the "
          "lift in another shape than the target has",
          where, deficit, excess, rms);
    case Cause::kAboveTarget:
      return absl::StrFormat("%s the skin lies outside its target, by %.2f mL (%.2f mm rms): fat cannot lower it",
                             where, excess, rms);
  }
  return "";
}

std::string describe_doubt(double before, double reached) {
  constexpr double kNear = 2e-3;  // [m]
  if (reached <= kNear) return "";
  return absl::StrFormat(
      "the skin stays %.1f mm rms from the target (%.1f mm before): the target may be of another face, in another "
      "frame, or lack more than these zones can fill; look at it before relying on the volumes",
      reached * kMillimetresPerMetre, before * kMillimetresPerMetre);
}

double foresee_without(const ProposalCase& face, const FittedVolumes& fitted, double misfit, Eigen::Index zone) {
  const Eigen::MatrixXd normal = fitted.reach.transpose() * face.points.area.asDiagonal() * fitted.reach;
  const double inverse = normal.completeOrthogonalDecomposition().pseudoInverse()(zone, zone);
  const double volume = fitted.volumes[zone];
  const double more = inverse > 0.0 ? volume * volume / inverse : 0.0;
  return std::sqrt(misfit * misfit + more / face.lacking_area());
}

}  // namespace lipofill::planning
