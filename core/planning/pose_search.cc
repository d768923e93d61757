#include "core/planning/pose_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "core/base/units.h"
#include "core/planning/skin_matcher.h"

namespace lipofill::planning {
namespace {

constexpr int kDenseSamples = 16'000;
constexpr int kFixedPoints = 500;
constexpr int kMovingPoints = 240;
constexpr size_t kMovingPairs = 160;
constexpr size_t kTriedOfAPair = 4000;
constexpr int kScoredSamples = 200;
constexpr double kNormalRadius = 0.010;  // [m]
constexpr double kCoarseCell = 0.004;    // [m]

constexpr double kShortestPair = 0.045;  // [m]
constexpr double kLongestPair = 0.110;   // [m]
constexpr double kLengthStep = 0.0065;   // [m]
constexpr double kAngleStep = 12.0 * kRadiansPerDegree;
constexpr int kLengthBins = 10;
constexpr int kAngleBins = 15;

/// Four whole numbers that a rigid motion does not change, up to rounding.
using PairFigures = std::array<int, 4>;
using FiledPair = std::array<uint16_t, 2>;

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

/// A frame that two points with normals define: along the line between them, then along what both
/// normals have across it. Nothing where that is little.
std::optional<Eigen::Matrix3d> make_frame(const SurfaceSamples& s, int a, int b) {
  Eigen::Matrix3d frame;
  frame.col(0) = (s.points.col(b) - s.points.col(a)).normalized();
  Eigen::Vector3d across = s.normals.col(a) + s.normals.col(b);
  across -= across.dot(frame.col(0)) * frame.col(0);
  constexpr double kLeastAcross = 0.8;
  if (across.norm() < kLeastAcross) return std::nullopt;
  frame.col(1) = across.normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

/// Nothing for a pair that is too near, too far or without a frame.
std::optional<PairFigures> describe_pair(const SurfaceSamples& s, int a, int b) {
  const Eigen::Vector3d line = s.points.col(b) - s.points.col(a);
  const double length = line.norm();
  if (length < kShortestPair || length >= kLongestPair || !make_frame(s, a, b)) return std::nullopt;
  const auto bin = [](double angle) { return std::min(kAngleBins - 1, static_cast<int>(angle / kAngleStep)); };
  return PairFigures{
      static_cast<int>((length - kShortestPair) / kLengthStep), bin(angle_between(s.normals.col(a), line / length)),
      bin(angle_between(s.normals.col(b), line / length)), bin(angle_between(s.normals.col(a), s.normals.col(b)))};
}

/// The ordered pairs of a surface, filed by their figures.
class PairFile {
 public:
  explicit PairFile(const SurfaceSamples& samples) : bins_(kLengthBins * kAngleBins * kAngleBins * kAngleBins) {
    const int n = static_cast<int>(samples.size());
    for (int a = 0; a < n; ++a) {
      for (int b = 0; b < n; ++b) {
        const auto figures = a == b ? std::nullopt : describe_pair(samples, a, b);
        if (figures) bins_[index_of(*figures)].push_back({static_cast<uint16_t>(a), static_cast<uint16_t>(b)});
      }
    }
  }

  /// The pairs whose figures differ by at most one step each; of very many, as on a ball, so many
  /// from everywhere among them.
  std::vector<FiledPair> find_like(const PairFigures& figures, size_t most) const {
    std::vector<FiledPair> like;
    for (int k = 0; k < 81; ++k) {
      PairFigures near = figures;
      near[0] += k % 3 - 1, near[1] += k / 3 % 3 - 1, near[2] += k / 9 % 3 - 1, near[3] += k / 27 - 1;
      if (near[0] < 0 || near[0] >= kLengthBins) continue;
      const bool inside =
          std::all_of(near.begin() + 1, near.end(), [](int bin) { return bin >= 0 && bin < kAngleBins; });
      if (!inside) continue;
      const std::vector<FiledPair>& bin = bins_[index_of(near)];
      like.insert(like.end(), bin.begin(), bin.end());
    }
    const size_t stride = like.size() / most + 1;
    std::vector<FiledPair> some;
    for (size_t k = 0; k < like.size(); k += stride) some.push_back(like[k]);
    return some;
  }

 private:
  static size_t index_of(const PairFigures& f) {
    return static_cast<size_t>(((f[0] * kAngleBins + f[1]) * kAngleBins + f[2]) * kAngleBins + f[3]);
  }
  std::vector<std::vector<FiledPair>> bins_;
};

/// Counts samples of the moving surface that a motion brings onto the fixed one.
class Scorer {
 public:
  Scorer(const SurfaceSamples& samples, const GridMatcher& fixed) : samples_(samples), fixed_(fixed) {}

  /// The share of all samples; 0 where the first few say that it is far below `bar`.
  double score(const RigidMotion& motion, double bar) const {
    constexpr double kReach = 0.007;  // [m]
    int hits = 0;
    for (int k = 0; k < samples_.size(); ++k) {
      // Samples follow the triangles: those that are tried first must be from everywhere.
      const auto at = static_cast<Eigen::Index>(k * 77 % samples_.size());
      hits += fixed_.match(motion.apply(samples_.points.col(at)), motion.rotation * samples_.normals.col(at), kReach)
                  .has_value();
      // About two standard deviations of so many trials.
      if ((k == 11 && hits < (bar - 0.28) * 12) || (k == 39 && hits < (bar - 0.15) * 40)) return 0.0;
    }
    return hits / static_cast<double>(samples_.size());
  }
  const Eigen::Matrix3Xd& points() const { return samples_.points; }

 private:
  SurfaceSamples samples_;
  const GridMatcher& fixed_;
};

void sort_best_first(std::vector<Placement>& placements) {
  std::stable_sort(placements.begin(), placements.end(),
                   [](const Placement& a, const Placement& b) { return a.score > b.score; });
}

/// The best placements that differ from all better ones by `apart` [m].
std::vector<Placement> keep_distinct(std::vector<Placement> placements, const Eigen::Matrix3Xd& points, double apart,
                                     size_t most) {
  sort_best_first(placements);
  std::vector<Placement> kept;
  for (const Placement& placement : placements) {
    if (kept.size() >= most) break;
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&](const Placement& better) {
      return compare_motions(better.motion, placement.motion, points) < apart;
    });
    if (is_new) kept.push_back(placement);
  }
  return kept;
}

/// Pairs of the moving surface, from all over it.
std::vector<std::array<int, 2>> choose_pairs(const SurfaceSamples& samples) {
  std::vector<std::array<int, 2>> pairs;
  const int n = static_cast<int>(samples.size());
  for (int step = 1; step < n && pairs.size() < kMovingPairs; ++step) {
    const int stride = step * 89 % n;
    for (int a = step % 7; a < n && pairs.size() < kMovingPairs; a += 7) {
      const int b = (a + stride) % n;
      if (a != b && describe_pair(samples, a, b)) pairs.push_back({a, b});
    }
  }
  return pairs;
}

absl::StatusOr<std::vector<Placement>> try_pairs(const SurfaceSamples& moving, const SurfaceSamples& fixed,
                                                 const Scorer& scorer, const Unwanted& unwanted) {
  constexpr size_t kKept = 2000;
  constexpr double kRival = 0.6;  // of the best score, for a placement that may become the best
  const PairFile file(fixed);
  std::vector<Placement> tried;
  double bar = 0.2;
  for (const auto& [a, b] : choose_pairs(moving)) {
    if (absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
    const Eigen::Matrix3d from = *make_frame(moving, a, b);
    const Eigen::Vector3d middle = 0.5 * (moving.points.col(a) + moving.points.col(b));
    for (const auto& [c, d] : file.find_like(*describe_pair(moving, a, b), kTriedOfAPair)) {
      Placement placement;
      placement.motion.rotation = *make_frame(fixed, c, d) * from.transpose();
      placement.motion.translation =
          0.5 * (fixed.points.col(c) + fixed.points.col(d)) - placement.motion.rotation * middle;
      placement.score = scorer.score(placement.motion, bar);
      if (placement.score < bar) continue;
      tried.push_back(placement);
      bar = std::max(bar, kRival * placement.score);
    }
    if (tried.size() < 2 * kKept) continue;
    sort_best_first(tried);
    tried.resize(kKept);
    bar = std::max(bar, tried.back().score);
  }
  return tried;
}

/// Aligns each placement and scores it anew.
std::vector<Placement> refine(std::vector<Placement> placements, const SurfaceSamples& moving, const GridMatcher& fixed,
                              const AlignmentRule& rule, double within) {
  for (Placement& placement : placements) {
    placement.motion = align_samples(moving, fixed, placement.motion, rule);
    placement.score = measure_fit(moving, fixed, placement.motion, rule.last_reach).score(within);
  }
  return placements;
}

}  // namespace

absl::StatusOr<std::vector<Placement>> search_poses(const SkinSurface& moving, const SkinSurface& fixed,
                                                    const Unwanted& unwanted) {
  const SurfaceSamples dense_fixed = sample_surface(fixed, kDenseSamples);
  const SurfaceSamples dense_moving = sample_surface(moving, kDenseSamples / 2);
  SurfaceSamples fixed_points = sample_surface(fixed, kFixedPoints);
  SurfaceSamples moving_points = sample_surface(moving, kMovingPoints);
  smooth_normals(fixed_points, dense_fixed, kNormalRadius);
  smooth_normals(moving_points, dense_moving, kNormalRadius);
  const GridMatcher grid(dense_fixed, kCoarseCell);
  const Scorer scorer(sample_surface(moving, kScoredSamples), grid);

  auto tried = try_pairs(moving_points, fixed_points, scorer, unwanted);
  if (!tried.ok()) return tried.status();
  auto placements = keep_distinct(*std::move(tried), scorer.points(), 0.012, 150);
  placements = refine(std::move(placements), sample_surface(moving, 300), grid, {0.015, 0.006, 20, 1e-5}, 0.003);
  placements = keep_distinct(std::move(placements), scorer.points(), 0.004, 12);
  placements = refine(std::move(placements), sample_surface(moving, 2000), grid, {0.008, 0.004, 30, 1e-6}, 0.0015);
  return keep_distinct(std::move(placements), scorer.points(), 0.004, 6);
}

}  // namespace lipofill::planning
