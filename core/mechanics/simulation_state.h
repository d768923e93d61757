#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace lipofill::mechanics {

/// A film's unknowns, and what it remembers.
struct FilmState {
  Eigen::VectorXd volume;                 ///< V [m3] (n_cells)
  Eigen::VectorXd pressure;               ///< p [Pa] (n_cells)
  Eigen::VectorXd velocity;               ///< U [m2/s] (n_edges)
  Eigen::VectorXd volume_rate;            ///< dV/dt of the last step [m3/s] (n_cells)
  Eigen::VectorXd pressure_rate;          ///< dp/dt of the last step [Pa/s] (n_cells)
  Eigen::VectorXd earlier_volume_rate;    ///< the step before the last had it [m3/s] (n_cells)
  Eigen::VectorXd earlier_pressure_rate;  ///< the same [Pa/s] (n_cells)
  Eigen::VectorXd wall_stress;            ///< T of film::FilmStepInput [Pa m] (n_edges); empty: fat is not elastic
  /// dt J when it was last kept, what solves of many cells are preconditioned with; empty: few
  /// cells.
  Eigen::VectorXd factored_mobility;
  Eigen::VectorXd is_entered;  ///< 1 where fat has parted the connective tissue, else 0 (n_cells); empty: all open
};

/// All that changes from step to step and decides the next: what a snapshot holds.
struct SimulationState {
  uint64_t step = 0;
  double time = 0.0;              ///< [s]
  double last_step = 0.0;         ///< size of the last step [s]
  double next_step = 0.0;         ///< size of the next step [s]
  uint64_t rejected_steps = 0;    ///< tried and taken back since the start
  int slow_steps = 0;             ///< steps in a row with the skin slower than the settling speed
  double skin_speed = 0.0;        ///< largest over the nodes of the skin in the last step [m/s]
  double injection_work = 0.0;    ///< done by sources since the start, sum of p dV [J]
  double film_dissipation = 0.0;  ///< lost to friction in the films since the start [J]
  Eigen::Matrix3Xd positions;     ///< [m]   (3, n_nodes); empty without tissue
  Eigen::Matrix3Xd velocities;    ///< [m/s] (3, n_nodes)
  /// Velocities of the three steps before the last, the latest first [m/s] (3, n_nodes).
  std::array<Eigen::Matrix3Xd, 3> earlier_velocities;
  int equal_steps = 0;               ///< so many in a row had the last one's size
  Eigen::VectorXd spring_is_intact;  ///< 1 or 0, of every spring of a ligament
  /// Positions of the tissue when its system was last factored; the factor serves later steps until
  /// it no longer converges.
  Eigen::Matrix3Xd factored_positions;
  Eigen::VectorXd factored_springs;  ///< spring_is_intact then
  double factored_dt = 0.0;          ///< [s]; 0: never factored
  int factored_in_double = 0;        ///< 1: float32 was not enough, now or before
  int late_iterations = 0;           ///< that an up-to-date factor would have saved, since then
  int late_pressure_iterations = 0;  ///< that up-to-date mobilities (FilmState::factored_mobility) would have saved
  std::vector<FilmState> films;
};

}  // namespace lipofill::mechanics
