#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/coupling/coupled_factor.h"
#include "core/coupling/film_solve.h"
#include "core/coupling/gap_system.h"
#include "core/film/advection.h"
#include "core/film/film_metric.h"
#include "core/film/film_projection.h"
#include "core/film/viscosity.h"
#include "core/mechanics/simulation_state.h"
#include "core/mechanics/tissue_setup.h"
#include "core/plan/film_layout.h"
#include "core/plan/simulation_spec.h"
#include "core/step/step_cost.h"

namespace lipofill::step {

/// What came of trying a step.
struct StepOutcome {
  bool accepted = false;
  std::string reason;  ///< why not
  mechanics::SimulationState state;
  Eigen::VectorXd gap;               ///< rest + g at the new positions [m3] (cells of all films)
  Eigen::VectorXd void_volume;       ///< of the gap, at the suction limit [m3] (cells of all films)
  double elastic_energy = 0.0;       ///< [J]
  double kinetic_energy = 0.0;       ///< of the tissue [J]
  Eigen::VectorXd spring_tension;    ///< of every spring of a ligament [N]
  Eigen::VectorXd spring_length;     ///< [m]
  double min_scaled_jacobian = 1.0;  ///< of the tissue at the new positions
  double error = 0.0;                ///< estimate of the step's own, set by the simulation [m]
  int film_iterations = 0;
  int newton_iterations = 0;
};

/// One implicit Euler step of tissue and films together.
///
///     S dx - B^T p = f                 tissue: S = M/dt^2 + D/dt + K at the positions x
///     B dx + dt J p = d                films:  d = V + injected - outflow at zero pressure - rest - g(x)
///
/// with J the tangent of the fat's flow law and p not below the suction limit (film_solve.h), repeated from the new
/// positions (Newton) until forces balance to kForceTolerance and the gap holds the film's volume to kGapTolerance.
/// What mismatch is left enters the next step's d: it cannot accumulate.
///
/// S, B and C on the left may be those of earlier positions: only the right sides decide where the iteration ends,
///
///     S0 dx - B0^T p' = f(x) + (B(x) - B0)^T p,     B0 dx + J p' = d(x)
///
/// A factor is kept until iterations stop converging fast or have cost as much as a new one. It is made in float32;
/// where that is not enough (no positive pivots, or a solve under load that leaves more than kFactorTolerance of the
/// load), in float64 from then on. Which factor is in use is part of the state, so that a restored simulation goes on
/// with the same bits.
///
/// A step starts from the last one carried on: x + dt v, p + dt dp/dt, V + dt dV/dt.
class CoupledStep {
 public:
  static absl::StatusOr<std::unique_ptr<CoupledStep>> create(const model::FaceModel& model,
                                                             const std::vector<plan::FilmLayout>& films,
                                                             const plan::SimulationSpec& spec);

  /// Everything at rest; films at rest thickness.
  mechanics::SimulationState rest_state() const;

  /// Opens the tissue for the films' initial thickness: equilibrium with every cell holding its volume, found by load
  /// stepping. INVALID_ARGUMENT with the field "films" when the tissue does not come to rest.
  absl::Status open_to_initial_thickness(mechanics::SimulationState& state);

  /// @param injected  volume into each cell of each film [m3]
  /// @param outcome   what came of it; the memory of an earlier one is used again, so that steps allocate nothing
  void try_step(const mechanics::SimulationState& state, const std::vector<Eigen::VectorXd>& injected, double dt,
                StepOutcome& outcome);

  int n_dofs() const { return tissue_ ? tissue_->tissue.n_dofs() : 0; }
  /// Memory of the factor, the compliance, the matrices and the vectors, once steps are taken [B].
  uint64_t memory_bytes() const;
  const mechanics::TissueSetup* tissue() const { return tissue_.get(); }
  /// Mid-surface metric of a film for a state.
  film::FilmMetric film_metric(const mechanics::SimulationState& state, int film) const;
  /// Areas of the cells of a film for a state, until the next step [m2] (n_cells).
  const Eigen::VectorXd& measure_area(const mechanics::SimulationState& state, int film);
  /// Cell areas at rest, of a film [m2].
  const Eigen::VectorXd& rest_area(int film) const { return rest_area_[film]; }
  /// Figures of a state that does not come from try_step: gap, void, energies, springs.
  StepOutcome describe(const mechanics::SimulationState& state);
  /// What was spent since reset_cost.
  const StepCost& cost() const { return cost_; }
  void reset_cost() { cost_ = {}; }

 private:
  CoupledStep(const model::FaceModel& model, const std::vector<plan::FilmLayout>& films,
              const plan::SimulationSpec& spec);
  absl::Status set_up();
  absl::StatusOr<std::shared_ptr<const coupling::GapGeometry>> share_gap(const plan::FilmLayout& film,
                                                                         const coupling::WallNodes& walls,
                                                                         const std::string& key);
  absl::Status analyse(const std::vector<std::string>& gap_keys);
  absl::Status check_every_cell_can_open();
  bool open_to(const Eigen::VectorXd& target, double tolerance, mechanics::SimulationState& state,
               Eigen::VectorXd& pressure);

  /// Brings the tissue's forces to positions and intact springs; does nothing where they are there already.
  void bring_forces_to(const mechanics::SimulationState& state, double dt);
  void assemble(const mechanics::SimulationState& state, double dt);
  void set_springs(const mechanics::SimulationState& state);
  /// The tissue's side of a Newton iteration: assembles at x and factors. False: not positive definite.
  bool linearise_tissue(const mechanics::SimulationState& state, double dt, coupling::Precision precision);
  /// Factors where the state says that it was factored last, unless that is the factor at hand. False: it cannot.
  bool take_up_factor(const mechanics::SimulationState& state);
  bool factor_here(double dt, mechanics::SimulationState& state);
  void keep_mobility(const mechanics::SimulationState& state);
  void take_up_mobility(const mechanics::SimulationState& state);
  void renew_mobility(mechanics::SimulationState& state, const coupling::FilmSolution& at);
  double measure_factor_error();
  void predict_rate(const mechanics::SimulationState& from, double dt, Eigen::VectorXd mechanics::FilmState::*last,
                    Eigen::VectorXd mechanics::FilmState::*before, Eigen::VectorXd& rate);
  void predict(const mechanics::SimulationState& from, double dt, mechanics::SimulationState& next,
               coupling::FilmSolution& solution);
  void set_gap_without_pressure(const coupling::FilmSolution& solution);
  void add_coupling_force(const Eigen::VectorXd& pressure, Eigen::VectorXd& force);
  double force_error(const Eigen::VectorXd& force, const Eigen::VectorXd& pressure);
  void compute_residual_force(const mechanics::SimulationState& from, const Eigen::Matrix3Xd& x, double dt,
                              Eigen::VectorXd& force);
  void begin_film_step(const mechanics::SimulationState& state, const std::vector<Eigen::VectorXd>& injected,
                       double dt);
  void move_freely(size_t film_index, const mechanics::FilmState& film, const film::Fat& fat, double dt,
                   Eigen::VectorXd& velocity);
  void update_metric(const mechanics::SimulationState& state, size_t film_index);
  void set_walls(coupling::WallCompliance& walls);
  bool is_implicit() const { return tissue_ && !factor_->has_compliance(); }
  coupling::FilmTolerance film_tolerance() const;
  void gather_tissue_part(const Eigen::VectorXd& all_cells, Eigen::VectorXd& part) const;
  void add_displacement(const Eigen::VectorXd& dx, Eigen::Matrix3Xd& x) const;
  void set_gap_of_walls(const Eigen::VectorXd& pressure, Eigen::VectorXd& gap) const;
  void set_lowest_pressure(const mechanics::SimulationState& state, Eigen::VectorXd& lowest) const;
  double gap_error(const Eigen::VectorXd& gap, const coupling::FilmSolution& solution) const;
  void enter_injected_cells(const std::vector<Eigen::VectorXd>& injected, mechanics::SimulationState& state) const;
  void finish_films(const mechanics::SimulationState& from, double dt, const coupling::FilmSolution& solution,
                    mechanics::SimulationState& next) const;
  void finish_tissue(const mechanics::SimulationState& from, double dt, StepOutcome& outcome);
  int n_ligament_springs() const;
  void compute_gap(const mechanics::SimulationState& state, Eigen::VectorXd& gap);
  void gather(const mechanics::SimulationState& state, Eigen::VectorXd mechanics::FilmState::*values,
              Eigen::VectorXd& all) const;
  void describe_tissue(StepOutcome& outcome, double dt);
  bool begin_tissue_step(const mechanics::SimulationState& from, double dt, StepOutcome& outcome,
                         const coupling::FilmSolution& start);
  bool renew_factor(double dt, StepOutcome& outcome, const coupling::FilmSolution& at);
  bool is_late(const StepOutcome& outcome) const;
  bool move_tissue(const mechanics::SimulationState& from, double dt, const Eigen::VectorXd& pressure,
                   StepOutcome& outcome);
  double measure_error(const coupling::FilmSolution& solution, double force_tolerance, StepOutcome& outcome);
  bool solve_tissue_and_films(const mechanics::SimulationState& from, double dt, StepOutcome& outcome,
                              coupling::FilmSolution& solution);
  bool solve_films(StepOutcome& outcome, coupling::FilmSolution& solution);

  const model::FaceModel& model_;
  const std::vector<plan::FilmLayout>& films_;
  plan::CouplingMode coupling_;
  Eigen::Vector3d gravity_;
  film::Fat fat_;
  double suction_limit_;  ///< [Pa], infinity: none
  std::unique_ptr<mechanics::TissueSetup> tissue_;
  std::unique_ptr<coupling::GapSystem> gaps_;
  std::unique_ptr<coupling::CoupledFactor> factor_;
  std::vector<int> gap_of_film_;     ///< index in gaps_, -1: a wall of its own
  std::vector<int> cell_offset_;     ///< first cell of each film among all, and one past the last
  std::vector<int> cell_of_tissue_;  ///< among all cells, of each row of gaps_
  Eigen::VectorXd rest_volume_;      ///< V of the films at rest [m3] (all cells)
  std::vector<Eigen::VectorXd> rest_area_;
  std::vector<film::FilmMetric> rest_metric_;
  std::vector<std::unique_ptr<film::FilmProjection>> projections_;
  std::unique_ptr<coupling::FilmSolver> film_solver_;
  std::vector<film::ImplicitViscosity> viscosity_;
  std::vector<film::Advection> advection_;
  std::vector<film::FilmMetric> metric_;  ///< of the step under way
  Eigen::Matrix3Xd forces_positions_;     ///< where the tissue's forces are
  Eigen::VectorXd forces_springs_;
  Eigen::Matrix3Xd factored_positions_;  ///< of the factor at hand
  Eigen::VectorXd factored_springs_;
  double factored_dt_ = 0.0;
  coupling::Precision factored_precision_ = coupling::Precision::kSingle;
  std::vector<Eigen::VectorXd> kept_mobility_;  ///< of each film, in the preconditioner at hand
  bool has_lagged_mobility_ = false;            ///< the state keeps the mobility that pressures are preconditioned with
  StepCost cost_;
  double least_force_ = 0.0;  ///< what counts as no force beside it [N]
  Eigen::VectorXd force_;     ///< residual force without that of the films [N]
  /// What a step writes into again and again.
  struct Workspace {
    coupling::FilmSolution solution;
    coupling::WallCompliance walls;
    Eigen::VectorXd pressure;              ///< of cells on tissue
    Eigen::VectorXd force;                 ///< what a solve starts from
    Eigen::VectorXd response;              ///< of the gaps on tissue
    Eigen::VectorXd gap_without_pressure;  ///< of all cells
    Eigen::VectorXd lowest;                ///< pressure, empty: no limit
    Eigen::VectorXd displacement;          ///< of the degrees of freedom
    Eigen::VectorXd of_films;              ///< force of the films
    Eigen::VectorXd moved;                 ///< since the start of the step, of the degrees of freedom
    Eigen::VectorXd rate, earlier_rate;    ///< of all cells
    std::vector<Eigen::VectorXd> mobility;
    Eigen::VectorXd thickness, edge_thickness, viscous, height;  ///< of one film
  };
  Workspace work_;
  Eigen::MatrixXd full_compliance_;  ///< of all cells, when films with other walls stand beside those on tissue
};

}  // namespace lipofill::step
