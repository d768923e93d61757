#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/planning/surface_samples.h"

namespace lipofill::planning {

/// Which sample of a surface is nearest, looked up in a grid of cubes around it: about a hundred
/// times as fast as searching a tree, and right but for what lies within a cube's width of the
/// border between two samples. Filled by passing the nearest sample on from cube to cube
/// (Danielsson 1980). Checked by tests/unit/planning/nearest_grid_test.cc.
class NearestGrid {
 public:
  /// @param cell    width of a cube [m]
  /// @param margin  of the grid around the samples [m]
  NearestGrid(const SurfaceSamples& samples, double cell, double margin);

  /// The sample that is nearest to the middle of the cube the point is in; -1 outside of the grid.
  int find(const Eigen::Vector3d& point) const;

 private:
  int index_of(const Eigen::Vector3i& cube) const { return cube[0] + size_[0] * (cube[1] + size_[1] * cube[2]); }
  Eigen::Vector3d middle_of(const Eigen::Vector3i& cube) const;
  void put(const SurfaceSamples& samples);
  /// Passes on along the rows, in the order of the cubes or against it.
  void sweep(const SurfaceSamples& samples, bool forwards);

  double cell_ = 0.0;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<int> nearest_;  ///< a sample a cube
};

}  // namespace lipofill::planning
