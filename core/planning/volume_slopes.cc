#include "core/planning/volume_slopes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lipofill::planning {

using Eigen::Index;
using Eigen::VectorXd;

absl::Status VolumeSlopes::differentiate(simulation::TrialShape& shape, const std::vector<SoughtZone>& zones) {
  skin_.resize(zones.size());
  pressure_.resize(static_cast<Index>(zones.size()), static_cast<Index>(zones.size()));
  const auto found = shape.find_injection_sensitivities();
  const auto pools = shape.pools();
  for (size_t z = 0; z < zones.size(); ++z) {
    if (z >= found.size() || !found[z]) {
      return absl::InternalError("what more fat in zone '" + zones[z].name + "' does to the skin was not found");
    }
    skin_[z] = found[z]->skin;
    for (size_t row = 0; row < zones.size(); ++row) {
      // The pools that the zone is part of; of one in two pieces the pressure that rises most.
      double rise = -std::numeric_limits<double>::infinity();
      for (size_t pool = 0; pool < pools.size(); ++pool) {
        if (!simulation::has_zone(pools[pool], zones[row].name)) continue;
        rise = std::max(rise, found[z]->pool_pressure[pool]);
      }
      pressure_(static_cast<Index>(row), static_cast<Index>(z)) = std::isfinite(rise) ? rise : 0.0;
    }
  }
  return absl::OkStatus();
}

void VolumeSlopes::learn(const VectorXd& volumes, const Eigen::Matrix3Xd& skin, const VectorXd& pressure) {
  const double square = volumes.squaredNorm();
  if (!(square > 0.0)) return;
  Eigen::Matrix3Xd missed = skin;
  for (size_t z = 0; z < skin_.size(); ++z) missed -= volumes[static_cast<Index>(z)] * skin_[z];
  for (size_t z = 0; z < skin_.size(); ++z) skin_[z] += volumes[static_cast<Index>(z)] / square * missed;
  const VectorXd missed_pressure = pressure - pressure_ * volumes;
  pressure_ += missed_pressure * volumes.transpose() / square;
}

Eigen::MatrixXd VolumeSlopes::of_distance(const SkinPoints& points, const Eigen::Matrix3Xd& direction) const {
  Eigen::MatrixXd slope(points.n(), static_cast<Index>(skin_.size()));
  for (size_t z = 0; z < skin_.size(); ++z) {
    const Eigen::Matrix3Xd moved = points.gather(skin_[z]);
    slope.col(static_cast<Index>(z)) = moved.cwiseProduct(direction).colwise().sum().transpose();
  }
  return slope;
}

}  // namespace lipofill::planning
