#include "core/step/step_start.h"

namespace lipofill::step {

void predict_positions(const mechanics::SimulationState& from, double dt, Eigen::Matrix3Xd& positions) {
  const bool is_one_size = from.equal_steps >= 4 && dt == from.last_step;
  if (!is_one_size) {
    positions = from.positions + dt * from.velocities;
    return;
  }
  positions = from.positions +
              dt * (kStartShares[0] * from.velocities + kStartShares[1] * from.earlier_velocities[0] +
                    kStartShares[2] * from.earlier_velocities[1] + kStartShares[3] * from.earlier_velocities[2]);
}

}  // namespace lipofill::step
