#include "core/geometry/chart_around.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/geometry/clear_rectangle.h"
#include "core/geometry/conformal_map.h"
#include "core/geometry/flat_patch.h"
#include "core/geometry/flat_region.h"
#include "core/geometry/footprint_samples.h"

namespace lipofill::geometry {
namespace {

constexpr double kBorderClearance = 1.5e-3;  // [m]
constexpr double kObstacleClearance = 2e-3;  // [m]
constexpr double kDegreesOfTurnBesideABorder = 5.0;
constexpr double kDegreesOfTurn = 2.0;  // between the directions tried
constexpr double kSharedShrink = 0.97;  // a rectangle whose grid leaves the skin is tried again so much smaller
constexpr int kMostShrinks = 12;

/// A rectangle of any direction: its frame, and its sides in it.
struct TurnedRectangle {
  Eigen::Matrix2d frame = Eigen::Matrix2d::Identity();  ///< its columns run along xi and eta
  Rectangle sides;
};

Rectangle box_around(const Eigen::Matrix2d& frame, const std::vector<Eigen::Vector2d>& points) {
  Rectangle box{Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()),
                Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity())};
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d q = frame.transpose() * p;
    box.low = box.low.cwiseMin(q);
    box.high = box.high.cwiseMax(q);
  }
  return box;
}

Eigen::Matrix2d frame_at(double degrees) {
  return Eigen::Rotation2Dd(degrees * std::numbers::pi / 180.0).toRotationMatrix();
}

/// The frame of the smallest rectangle.
Eigen::Matrix2d choose_smallest(const FlatPatch& patch, double margin) {
  double smallest = std::numeric_limits<double>::infinity();
  Eigen::Matrix2d best = Eigen::Matrix2d::Identity();
  for (double degrees = 0.0; degrees < 90.0; degrees += kDegreesOfTurn) {
    const Rectangle box = box_around(frame_at(degrees), patch.outline);
    const double area = (box.high - box.low + Eigen::Vector2d::Constant(2.0 * margin)).prod();
    if (area >= smallest * (1.0 - 1e-9)) continue;
    smallest = area;
    best = frame_at(degrees);
  }
  return best;
}

/// The frame turned by right angles until eta runs up.
Eigen::Matrix2d turn_upright(const FlatPatch& patch, Eigen::Matrix2d frame) {
  const Eigen::Matrix2d quarter = frame_at(90.0);
  Eigen::Matrix2d upright = frame;
  for (int k = 0; k < 4; ++k, frame = quarter * frame) {
    if (frame.col(1).dot(patch.up) > upright.col(1).dot(patch.up)) upright = frame;
  }
  return upright;
}

Quadrilateral corners_of(const TurnedRectangle& turned) {
  const Rectangle& r = turned.sides;
  return {turned.frame * r.low, turned.frame * Eigen::Vector2d(r.high.x(), r.low.y()), turned.frame * r.high,
          turned.frame * Eigen::Vector2d(r.low.x(), r.high.y())};
}

/// A rectangle and the story of its sides.
struct ChosenRectangle {
  TurnedRectangle turned;
  Rectangle box;
  std::array<int, 4> obstacle_of_side{};
  std::ptrdiff_t kept = 0;  ///< points of the footprints that lie in it
};

ChosenRectangle clear_in_frame(const FlatPatch& patch, double margin, const Eigen::Matrix2d& frame) {
  ChosenRectangle chosen;
  chosen.turned.frame = turn_upright(patch, frame);
  const Eigen::Matrix2d into = chosen.turned.frame.transpose();
  chosen.box = box_around(chosen.turned.frame, patch.outline);
  std::vector<ObstaclePoint> obstacles;
  for (const PlacedObstacle& obstacle : patch.obstacles) {
    const double clearance = obstacle.may_cut ? kBorderClearance : kObstacleClearance;
    obstacles.push_back({into * obstacle.flat, clearance * patch.scale, obstacle.may_cut});
  }
  std::vector<Eigen::Vector2d> content;
  for (const Eigen::Vector2d& p : patch.content) content.push_back(into * p);
  const ClearRectangle clear = find_clear_rectangle(chosen.box, margin, obstacles, content);
  chosen.turned.sides = clear.rectangle;
  chosen.obstacle_of_side = clear.obstacle_of_side;
  chosen.kept = std::count_if(content.begin(), content.end(),
                              [&](const Eigen::Vector2d& p) { return clear.rectangle.contains(p); });
  return chosen;
}

/// The smallest rectangle; where a border cuts it, the one of all directions that keeps most of the
/// footprints.
ChosenRectangle choose_rectangle(const FlatPatch& patch, double margin) {
  ChosenRectangle best = clear_in_frame(patch, margin, choose_smallest(patch, margin));
  if (best.kept == std::ssize(patch.content)) return best;
  for (double degrees = 0.0; degrees < 90.0; degrees += kDegreesOfTurnBesideABorder) {
    ChosenRectangle other = clear_in_frame(patch, margin, frame_at(degrees));
    if (other.kept > best.kept) best = std::move(other);
  }
  return best;
}

/// The share of each footprint in the rectangle, and the obstacle nearest to what is lost.
struct KeptShare {
  double share = 1.0;
  int blamed = -1;
};

KeptShare measure_share(const SurfaceMesh& mesh, const FlatPatch& patch, const Quadrilateral& quad,
                        const std::vector<FootprintSample>& samples) {
  int all = 0;
  int kept = 0;
  Eigen::Vector3d lost = Eigen::Vector3d::Zero();
  for (const FootprintSample& sample : samples) {
    if (sample.is_outline) continue;
    ++all;
    if (!sample.is_beyond && contains(quad, place_in_plane(mesh, patch.flat, sample.skin))) {
      ++kept;
    } else {
      lost += sample.skin.position;
    }
  }
  KeptShare result{static_cast<double>(kept) / all, -1};
  if (kept == all) return result;
  lost /= all - kept;
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < patch.obstacles.size(); ++k) {
    const double distance = (patch.obstacles[k].position - lost).norm();
    if (patch.obstacles[k].name.empty() || distance >= nearest) continue;
    nearest = distance;
    result.blamed = static_cast<int>(k);
  }
  return result;
}

std::string blame(const FlatPatch& patch, int obstacle) {
  if (obstacle < 0) return "";
  const PlacedObstacle& found = patch.obstacles[obstacle];
  return absl::StrCat(": ", found.name, " lies near ", in_mm(found.position));
}

/// Remarks on footprints that are not whole; a violation for each that is too small.
absl::Status judge_shares(const SurfaceMesh& mesh, const FlatPatch& patch, const Quadrilateral& quad,
                          const ChartAroundRequest& request, const Samples& samples,
                          std::vector<std::string>& remarks) {
  FieldViolations violations;
  for (size_t k = 0; k < samples.size(); ++k) {
    const Footprint& footprint = request.footprints[k];
    const KeptShare kept = measure_share(mesh, patch, quad, samples[k]);
    if (kept.share >= kWholeZoneShare) continue;
    const std::string why = blame(patch, kept.blamed);
    if (kept.share < kSmallestZoneShare) {
      violations.add(footprint.field,
                     absl::StrFormat("is '%s', of which only %.2f lies on skin that can be modelled, must be at least "
                                     "%.1f%s; take a scan that reaches farther, move the landmarks or choose another "
                                     "region",
                                     footprint.name, kept.share, kSmallestZoneShare, why));
    } else {
      remarks.push_back(absl::StrFormat("Only %.2f of %s lies on the model%s.", kept.share, footprint.name, why));
    }
  }
  return violations.to_status();
}

/// Says which sides have less margin than was asked for, each obstacle once.
void remark_on_margins(const FlatPatch& patch, const ChosenRectangle& chosen, double wanted,
                       std::vector<std::string>& remarks) {
  std::map<std::string, std::pair<double, int>> least;
  for (int side = 0; side < 4; ++side) {
    const int obstacle = chosen.obstacle_of_side[side];
    if (obstacle < 0 || patch.obstacles[obstacle].name.empty()) continue;
    const Rectangle& sides = chosen.turned.sides;
    const double left = side % 2 == 0 ? chosen.box.low[side / 2] - sides.low[side / 2]
                                      : sides.high[side / 2] - chosen.box.high[side / 2];
    if (left < 0.0) continue;
    const auto [found, is_new] = least.try_emplace(patch.obstacles[obstacle].name, left, obstacle);
    if (!is_new && left < found->second.first) found->second = {left, obstacle};
  }
  for (const auto& [name, place] : least) {
    remarks.push_back(absl::StrFormat("The zones have %.1f mm of skin around them in place of %.1f: %s lies near %s.",
                                      place.first / patch.scale * 1e3, wanted * 1e3, name,
                                      in_mm(patch.obstacles[place.second].position)));
  }
}

void remark_on_obstacles_within(const FlatPatch& patch, const Quadrilateral& quad, std::vector<std::string>& remarks) {
  std::map<std::string, int> within;
  for (size_t k = 0; k < patch.obstacles.size(); ++k) {
    const PlacedObstacle& obstacle = patch.obstacles[k];
    if (!obstacle.may_cut && obstacle.name != kSharpBend && contains(quad, obstacle.flat))
      within.try_emplace(obstacle.name, static_cast<int>(k));
  }
  for (const auto& [name, k] : within) {
    remarks.push_back(absl::StrCat("The model reaches over ", name, " near ", in_mm(patch.obstacles[k].position),
                                   ", where the skin is not held as it is simulated."));
  }
}

void shrink(TurnedRectangle& turned) {
  const Eigen::Vector2d centre = 0.5 * (turned.sides.low + turned.sides.high);
  turned.sides.low = centre + kSharedShrink * (turned.sides.low - centre);
  turned.sides.high = centre + kSharedShrink * (turned.sides.high - centre);
}

/// The chart of the rectangle, or of one a little smaller where the grid would leave the skin.
absl::StatusOr<RegionChart> sample_rectangle(const SurfaceMesh& mesh, const FlatPatch& patch, TurnedRectangle& turned,
                                             int n_xi, int n_eta) {
  absl::StatusOr<RegionChart> chart = absl::FailedPreconditionError("");
  for (int k = 0; k <= kMostShrinks; ++k, shrink(turned)) {
    const Quadrilateral quad = corners_of(turned);
    if (const int fold = find_fold(mesh, patch.flat, quad); fold >= 0) {
      chart = describe_fold(mesh, fold);
      continue;
    }
    chart = sample_chart(mesh, {patch.flat, quad}, n_xi, n_eta);
    if (chart.ok()) break;
  }
  return chart;
}

absl::StatusOr<ChartAround> chart_flat(const RegionPatch& region, const ChartAroundRequest& request,
                                       const Samples& samples, const FlatPatch& patch, int n_xi, int n_eta) {
  ChosenRectangle chosen = choose_rectangle(patch, request.margin * patch.scale);
  ChartAround result;
  const auto judge = [&] {
    result.remarks.clear();
    return judge_shares(region.mesh, patch, corners_of(chosen.turned), request, samples, result.remarks);
  };
  if (const absl::Status whole = judge(); !whole.ok()) return whole;
  auto chart = sample_rectangle(region.mesh, patch, chosen.turned, n_xi, n_eta);
  if (!chart.ok()) return chart.status();
  if (const absl::Status whole = judge(); !whole.ok()) return whole;
  remark_on_margins(patch, chosen, request.margin, result.remarks);
  remark_on_obstacles_within(patch, corners_of(chosen.turned), result.remarks);
  result.chart = *std::move(chart);
  const auto at = [&](int i, int j) -> Eigen::Vector3d { return result.chart.points.col(j * (n_xi + 1) + i); };
  result.corners = {at(0, 0), at(n_xi, 0), at(n_xi, n_eta), at(0, n_eta)};
  return result;
}

}  // namespace

absl::StatusOr<ChartAround> chart_around(const RegionPatch& patch, const ChartAroundRequest& request, int n_xi,
                                         int n_eta) {
  const SkinReach reach(patch.mesh);
  Samples samples;
  for (const Footprint& footprint : request.footprints) {
    samples.push_back(sample_footprint(patch.mesh, reach, footprint));
  }
  const auto [pin_a, pin_b] = choose_pins(patch.mesh, request.footprints);
  absl::StatusOr<ChartAround> result = absl::FailedPreconditionError("");
  // The map with mean-value weights is farther from conformal, but does not fold.
  for (const bool conformal : {true, false}) {
    auto flat = conformal ? compute_conformal_map(patch.mesh, pin_a, pin_b) : compute_harmonic_map(patch.mesh);
    if (!flat.ok()) return flat.status();
    const FlatPatch flattened = place_in_flat(patch, request, reach, samples, *std::move(flat));
    result = chart_flat(patch, request, samples, flattened, n_xi, n_eta);
    if (!absl::IsFailedPrecondition(result.status())) return result;
  }
  return result;
}

}  // namespace lipofill::geometry
