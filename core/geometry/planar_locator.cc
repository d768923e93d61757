#include "core/geometry/planar_locator.h"

#include <algorithm>
#include <cmath>

namespace lipofill::geometry {
namespace {

constexpr double kEdgeTolerance = 1e-9;  // a barycentric coordinate may be so far below 0
constexpr int kMaxBinsAlong = 512;

}  // namespace

double compute_signed_area(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

PlanarLocator::PlanarLocator(const Eigen::Matrix2Xd& points, const std::vector<std::array<int, 3>>& triangles)
    : points_(points), triangles_(triangles), low_(points.rowwise().minCoeff()) {
  const Eigen::Vector2d extent = points.rowwise().maxCoeff() - low_;
  bin_size_ = std::sqrt(extent.x() * extent.y() / static_cast<double>(triangles.size() + 1));
  bin_size_ = std::max({bin_size_, extent.maxCoeff() / kMaxBinsAlong, 1e-12});
  for (int c = 0; c < 2; ++c) n_bins_[c] = 1 + static_cast<int>(extent[c] / bin_size_);
  bins_.resize(static_cast<size_t>(n_bins_[0]) * static_cast<size_t>(n_bins_[1]));
  for (size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    if (!(compute_signed_area(points.col(a), points.col(b), points.col(c)) > 0.0)) continue;
    const auto first = bin_of(points.col(a).cwiseMin(points.col(b)).cwiseMin(points.col(c)));
    const auto last = bin_of(points.col(a).cwiseMax(points.col(b)).cwiseMax(points.col(c)));
    for (int j = first[1]; j <= last[1]; ++j) {
      for (int i = first[0]; i <= last[0]; ++i) bins_[j * n_bins_[0] + i].push_back(static_cast<int>(t));
    }
  }
}

std::array<int, 2> PlanarLocator::bin_of(const Eigen::Vector2d& point) const {
  std::array<int, 2> bin{};
  for (int c = 0; c < 2; ++c) {
    const double place = std::clamp((point[c] - low_[c]) / bin_size_, 0.0, n_bins_[c] - 1.0);
    bin[c] = static_cast<int>(place);
  }
  return bin;
}

PlanarLocator::Place PlanarLocator::find(const Eigen::Vector2d& point) const {
  const auto [i, j] = bin_of(point);
  Place best;
  double best_margin = -kEdgeTolerance;
  for (const int t : bins_[j * n_bins_[0] + i]) {
    const auto& [a, b, c] = triangles_[t];
    const double whole = compute_signed_area(points_.col(a), points_.col(b), points_.col(c));
    const Eigen::Vector3d barycentric(compute_signed_area(point, points_.col(b), points_.col(c)) / whole,
                                      compute_signed_area(point, points_.col(c), points_.col(a)) / whole,
                                      compute_signed_area(point, points_.col(a), points_.col(b)) / whole);
    if (barycentric.minCoeff() <= best_margin) continue;
    best_margin = barycentric.minCoeff();
    best = {t, barycentric};
  }
  return best;
}

}  // namespace lipofill::geometry
