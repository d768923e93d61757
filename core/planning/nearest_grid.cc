#include "core/planning/nearest_grid.h"

#include <array>

namespace lipofill::planning {
namespace {

/// The thirteen neighbours of a cube that come before it in the order of the cubes.
std::array<Eigen::Vector3i, 13> list_earlier_neighbours() {
  std::array<Eigen::Vector3i, 13> earlier;
  size_t n = 0;
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1 && n < earlier.size(); ++x) earlier[n++] = {x, y, z};
    }
  }
  return earlier;
}

}  // namespace

NearestGrid::NearestGrid(const SurfaceSamples& samples, double cell, double margin) : cell_(cell) {
  low_ = samples.points.rowwise().minCoeff().array() - margin;
  const Eigen::Vector3d high = samples.points.rowwise().maxCoeff().array() + margin;
  size_ = ((high - low_) / cell).array().ceil().cast<int>().max(1);
  nearest_.assign(static_cast<size_t>(size_[0]) * size_[1] * size_[2], -1);
  put(samples);
  for (int pass = 0; pass < 2; ++pass) {
    sweep(samples, true);
    sweep(samples, false);
  }
}

Eigen::Vector3d NearestGrid::middle_of(const Eigen::Vector3i& cube) const {
  return low_ + cell_ * (cube.cast<double>().array() + 0.5).matrix();
}

int NearestGrid::find(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d place = (point - low_) / cell_;
  if (!(place.array() >= 0.0).all() || !(place.array() < size_.cast<double>().array()).all()) return -1;
  return nearest_[index_of(place.cast<int>())];
}

void NearestGrid::put(const SurfaceSamples& samples) {
  for (int k = 0; k < samples.size(); ++k) {
    const Eigen::Vector3i cube = ((samples.points.col(k) - low_) / cell_).cast<int>();
    int& nearest = nearest_[index_of(cube)];
    const Eigen::Vector3d middle = middle_of(cube);
    if (nearest < 0 ||
        (samples.points.col(k) - middle).squaredNorm() < (samples.points.col(nearest) - middle).squaredNorm()) {
      nearest = k;
    }
  }
}

void NearestGrid::sweep(const SurfaceSamples& samples, bool forwards) {
  static const std::array<Eigen::Vector3i, 13> earlier = list_earlier_neighbours();
  const int n = static_cast<int>(nearest_.size());
  for (int i = 0; i < n; ++i) {
    const int index = forwards ? i : n - 1 - i;
    const Eigen::Vector3i cube(index % size_[0], index / size_[0] % size_[1], index / size_[0] / size_[1]);
    const Eigen::Vector3d middle = middle_of(cube);
    int& nearest = nearest_[index];
    double squared = nearest < 0 ? -1.0 : (samples.points.col(nearest) - middle).squaredNorm();
    for (const Eigen::Vector3i& step : earlier) {
      const Eigen::Vector3i beside = forwards ? (cube + step).eval() : (cube - step).eval();
      if ((beside.array() < 0).any() || (beside.array() >= size_.array()).any()) continue;
      const int offered = nearest_[index_of(beside)];
      if (offered < 0 || offered == nearest) continue;
      const double squared_offered = (samples.points.col(offered) - middle).squaredNorm();
      if (squared >= 0.0 && squared_offered >= squared) continue;
      squared = squared_offered;
      nearest = offered;
    }
  }
}

}  // namespace lipofill::planning
