#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include "core/coupling/film_solve.h"
#include "core/film/film_projection.h"
#include "core/mechanics/film_geometry.h"
#include "core/mechanics/step_cost.h"
#include "core/plan/simulation_spec.h"
#include "core/step/film_motion.h"
#include "core/step/lagged_mobility.h"
#include "core/step/wall_response.h"

namespace lipofill::step {

/// The fat that all films of a simulation hold.
film::Fat make_fat(const plan::SimulationSpec& spec);

/// The films' side of a coupled step: forces, viscosity and advection first (begin), then the
/// pressure that makes each film fill its gap (solve), in the end the films' new state (finish).
/// Checked by tests/unit/step/film_step_test.cc and tests/verification/film/.
class FilmStep {
 public:
  /// @param factor  of the tissue, null without any
  /// @param cost    takes times and iterations; what is passed here outlives the step
  FilmStep(const std::vector<plan::FilmLayout>& films, const mechanics::FilmCells& cells,
           mechanics::FilmGeometry& geometry, const plan::SimulationSpec& spec, coupling::CoupledFactor* factor,
           mechanics::StepCost& cost);

  /// Sets the states of films at rest thickness into `state`.
  void set_rest(mechanics::SimulationState& state) const;

  /// Brings the walls' compliance to what the factor holds.
  void update_walls();
  LaggedMobility& mobility() { return *mobility_; }
  const WallResponse& walls() const { return walls_; }

  /// Takes the velocity, the body forces and the sources of a step of `dt` [s] from a state. Cells
  /// that are injected into count as entered from now on: the cannula parts the tissue where it
  /// delivers.
  void begin(const std::vector<Eigen::VectorXd>& injected, double dt, mechanics::SimulationState& state);
  /// Starts from the fluxes of the last step.
  void set_start_flux(const mechanics::SimulationState& from, coupling::FilmSolution& start) const;
  /// Solves for the pressure with which the films fill their gaps, and counts what that takes.
  /// False: the film does not converge.
  /// @param gap_without_pressure  [m3] (n cells)
  /// @param state                 counts iterations that up-to-date mobilities would have saved
  bool solve(const Eigen::VectorXd& gap_without_pressure, mechanics::SimulationState& state,
             coupling::FilmSolution& solution);
  /// Writes the films of the next state.
  void finish(const mechanics::SimulationState& from, double dt, const coupling::FilmSolution& solution,
              mechanics::SimulationState& next) const;

  /// Finds which part of a state's gap [m3] (n cells) is void at the suction limit.
  Eigen::VectorXd compute_void(const mechanics::SimulationState& state, const Eigen::VectorXd& gap) const;

 private:
  void begin_film(size_t film, const Eigen::VectorXd& injected, double dt, const mechanics::SimulationState& state);
  void find_lowest_pressure(const mechanics::SimulationState& state, Eigen::VectorXd& lowest) const;
  coupling::FilmTolerance tolerance() const;

  const std::vector<plan::FilmLayout>& films_;
  const mechanics::FilmCells& cells_;
  mechanics::FilmGeometry& geometry_;
  mechanics::StepCost& cost_;
  Eigen::Vector3d gravity_;
  film::Fat fat_;
  double suction_limit_;  ///< [Pa], infinity: none
  WallResponse walls_;
  std::vector<FilmMotion> motion_;
  std::vector<std::unique_ptr<film::FilmProjection>> projections_;
  std::unique_ptr<coupling::FilmSolver> solver_;
  std::unique_ptr<LaggedMobility> mobility_;
  Eigen::VectorXd lowest_;  ///< pressure of each cell [Pa]; empty: no limit
  Eigen::VectorXd height_;  ///< of one film's cells along gravity
};

}  // namespace lipofill::step
