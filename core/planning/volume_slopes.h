#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/status.h"
#include "core/planning/proposal_points.h"
#include "core/planning/proposal_zones.h"
#include "core/simulation/trial_shape.h"

namespace lipofill::planning {

/// The slopes are what a unit of each zone's volume does to the skin and to the pressures of the
/// zones: solved for at a shape, and then learned from the steps (Broyden). Checked by
/// tests/unit/planning/proposal_test.cc.
class VolumeSlopes {
 public:
  /// Takes those of a shape's zones. INTERNAL where one is not found.
  absl::Status differentiate(simulation::TrialShape& shape, const std::vector<SoughtZone>& zones);
  /// Takes the least change that makes the slopes true of a step of the volumes [m3], which moved
  /// the nodes of the skin [m] and the pressures [Pa].
  void learn(const Eigen::VectorXd& volumes, const Eigen::Matrix3Xd& skin, const Eigen::VectorXd& pressure);

  /// Each volume moves the nodes of the skin by this [1/m2].
  const std::vector<Eigen::Matrix3Xd>& skin() const { return skin_; }
  /// Each volume (columns) changes each zone's pressure (rows) by this [Pa/m3].
  const Eigen::MatrixXd& pressure() const { return pressure_; }
  /// Finds how the points' distances from the target change with the volumes [1/m2] (n, zones).
  /// @param direction  the gradient of each distance
  Eigen::MatrixXd of_distance(const SkinPoints& points, const Eigen::Matrix3Xd& direction) const;

 private:
  std::vector<Eigen::Matrix3Xd> skin_;
  Eigen::MatrixXd pressure_;
};

}  // namespace lipofill::planning
