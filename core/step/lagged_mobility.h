#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/coupling/film_solve.h"
#include "core/mechanics/simulation_state.h"

namespace lipofill::step {

/// The mobilities dt J that the pressures of many cells are preconditioned with. They stay from
/// step to step until up-to-date ones would have saved as many iterations as they cost; the state
/// holds them, so that a restored simulation goes on with the same bits
/// (FilmState::factored_mobility).
class LaggedMobility {
 public:
  /// @param is_used  whether solves with these walls need it at all
  LaggedMobility(coupling::FilmSolver& solver, bool is_used) : solver_(solver), is_used_(is_used) {}

  bool is_used() const { return is_used_; }
  /// Preconditions as the state says, unless it is so at present.
  void take_up(const mechanics::SimulationState& state);
  /// True when iterations that new mobilities would have saved have cost as much as they do.
  bool is_due(const mechanics::SimulationState& state) const;
  /// Preconditions with the mobilities of a solution, and notes them in the state.
  void renew(const coupling::FilmSolution& at, mechanics::SimulationState& state);
  /// Drops the preconditioner, which does not have the compliance of a new factor yet.
  void forget() { kept_.clear(); }

 private:
  void keep(const mechanics::SimulationState& state);

  coupling::FilmSolver& solver_;
  bool is_used_;
  std::vector<Eigen::VectorXd> kept_;  ///< of each film, in the preconditioner at hand
  std::vector<Eigen::VectorXd> measured_;
};

}  // namespace lipofill::step
