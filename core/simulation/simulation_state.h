#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace lipofill::simulation {

/// A film's unknowns.
struct FilmState {
  Eigen::VectorXd volume;    ///< V [m3] (n_cells)
  Eigen::VectorXd pressure;  ///< p [Pa] (n_cells)
  Eigen::VectorXd velocity;  ///< U [m2/s] (n_edges)
};

/// All that changes from step to step and decides the next: what a snapshot holds.
struct SimulationState {
  uint64_t step = 0;
  double time = 0.0;            ///< [s]
  double next_step = 0.0;       ///< size of the next step [s]
  int slow_steps = 0;           ///< steps in a row with the skin slower than the settling speed
  Eigen::Matrix3Xd positions;   ///< [m]   (3, n_nodes); empty without tissue
  Eigen::Matrix3Xd velocities;  ///< [m/s] (3, n_nodes)
  std::vector<FilmState> films;
};

}  // namespace lipofill::simulation
