#include "core/step/predictor.h"

namespace lipofill::step {
namespace {

/// Equal steps after which films are carried on along a parabola: before that, not all began in the
/// same way.
constexpr int kStepsOfACurve = 3;

}  // namespace

void Predictor::predict_positions(const mechanics::SimulationState& from, double dt, Eigen::Matrix3Xd& positions) {
  const bool is_one_size = from.equal_steps >= 4 && dt == from.last_step;
  if (!is_one_size) {
    positions = from.positions + dt * from.velocities;
    return;
  }
  positions = from.positions +
              dt * (kStartShares[0] * from.velocities + kStartShares[1] * from.earlier_velocities[0] +
                    kStartShares[2] * from.earlier_velocities[1] + kStartShares[3] * from.earlier_velocities[2]);
}

void Predictor::predict_films(const mechanics::SimulationState& from, double dt, coupling::FilmSolution& start) {
  using mechanics::FilmState;
  cells_.gather(from, &FilmState::pressure, start.pressure);
  predict_rate(from, dt, &FilmState::pressure_rate, &FilmState::earlier_pressure_rate);
  start.pressure += dt * rate_;
  cells_.gather(from, &FilmState::volume, start.volume);
  predict_rate(from, dt, &FilmState::volume_rate, &FilmState::earlier_volume_rate);
  start.volume = (start.volume + dt * rate_).cwiseMax(0.0);
}

/// Takes each cell to change as it did in the last step or, after steps of this size, as the change
/// itself changed.
void Predictor::predict_rate(const mechanics::SimulationState& from, double dt,
                             Eigen::VectorXd mechanics::FilmState::*last,
                             Eigen::VectorXd mechanics::FilmState::*before) {
  cells_.gather(from, last, rate_);
  const bool is_one_size = from.equal_steps >= kStepsOfACurve && dt == from.last_step;
  if (!is_one_size) return;
  cells_.gather(from, before, earlier_rate_);
  rate_ += rate_ - earlier_rate_;
}

}  // namespace lipofill::step
