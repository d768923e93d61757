#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/geometry/cut_rectangle.h"
#include "core/geometry/layered_grid.h"

namespace lipofill::plan {

/// Straight distance from a zone's outline, both on the undeformed skin.
class ZoneDistance {
 public:
  /// The outline is traced twice as finely as the grid.
  ZoneDistance(const geometry::LayeredGrid& grid, const geometry::Level& level);

  /// [m], infinite where it is more than `reach` and where the zone has no outline on the chart.
  double to_outline(const Eigen::Vector3d& point, double reach) const;

 private:
  std::vector<std::array<Eigen::Vector3d, 2>> segments_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  double radius_ = 0.0;  ///< of a ball around the centre that holds the outline
};

}  // namespace lipofill::plan
