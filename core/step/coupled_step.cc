#include "core/step/coupled_step.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/solid/hex_quality.h"
#include "core/step/initial_opening.h"
#include "core/step/step_memory.h"

namespace lipofill::step {
namespace {

using mechanics::PhaseTimer;
using mechanics::SimulationState;

constexpr int kMaxNewtonIterations = 16;
/// Forces out of balance over forces in balance, after an iteration with a factor of earlier
/// positions; and after one with a factor of its own, whose error is of second order.
constexpr double kForceTolerance = 1e-3;
constexpr double kPromptForceTolerance = 1e-2;
/// An iteration that leaves more of the error than this calls for a new factor.
constexpr double kLeastGain = 0.3;
/// Iterations of a step that a new factor would need too.
constexpr int kPromptIterations = 2;
/// Sum over cells of |gap - film| over the film's volume; well inside the 1e-4 that is promised.
constexpr double kGapTolerance = 2e-5;

constexpr const char* kNotDefinite = "the tissue's stiffness is not positive definite";

}  // namespace

absl::StatusOr<std::unique_ptr<CoupledStep>> CoupledStep::create(const model::FaceModel& model,
                                                                 const std::vector<plan::FilmLayout>& films,
                                                                 const plan::SimulationSpec& spec) {
  std::unique_ptr<CoupledStep> step(new CoupledStep(films));
  if (!model.layers.empty()) {
    auto system = mechanics::TissueSystem::create(model, films, step->cells_, spec, step->cost_);
    if (!system.ok()) return system.status();
    step->system_ = *std::move(system);
    auto factor = mechanics::HeldFactor::create(model, *step->system_, step->cost_);
    if (!factor.ok()) return factor.status();
    step->factor_ = *std::move(factor);
    step->forces_ = std::make_unique<ResidualForce>(*step->system_, spec.gravity);
  }
  coupling::CoupledFactor* factor = step->factor_ ? &step->factor_->factor() : nullptr;
  step->geometry_ =
      std::make_unique<mechanics::FilmGeometry>(model.geometry.grid, films, step->cells_, step->system_.get());
  step->films_ = std::make_unique<FilmStep>(films, step->cells_, *step->geometry_, spec, factor, step->cost_);
  return step;
}

SimulationState CoupledStep::rest_state() const {
  SimulationState state;
  if (system_) system_->set_rest(state);
  films_->set_rest(state);
  return state;
}

absl::Status CoupledStep::open_to_initial_thickness(SimulationState& state) {
  return step::open_to_initial_thickness(
      {layouts_, cells_, *geometry_, films_->walls().rest_volume(), system_.get(), factor_.get(), forces_.get()},
      state);
}

uint64_t CoupledStep::memory_bytes() const {
  return estimate_memory(cells_.n(), system_.get(), factor_.get());
}

void CoupledStep::try_step(const SimulationState& state, const std::vector<Eigen::VectorXd>& injected, double dt,
                           StepOutcome& outcome) {
  outcome.accepted = false;
  outcome.reason.clear();
  outcome.state = state;
  films_->begin(injected, dt, outcome.state);
  predict(state, dt, outcome.state);
  if (!solve_tissue_and_films(state, dt, outcome)) return;
  outcome.void_volume = solution_.void_volume;
  finish_tissue(state, dt, outcome);
  films_->finish(state, dt, solution_, outcome.state);
  outcome.state.time = state.time + dt;
  outcome.state.step = state.step + 1;
  outcome.state.last_step = dt;
  outcome.accepted = true;
}

/// Carries the last steps on, unless that would turn an element inside out.
void CoupledStep::predict(const SimulationState& from, double dt, SimulationState& next) {
  predictor_.predict_films(from, dt, solution_);
  films_->set_start_flux(from, solution_);
  if (!system_ || from.velocities.isZero(0.0)) return;
  Predictor::predict_positions(from, dt, next.positions);
  system_->bring_forces_to(next.positions, next.spring_is_intact, dt);
  if (system_->tissue().min_volume_ratio() <= 0.0) next.positions = from.positions;
}

bool CoupledStep::solve_tissue_and_films(const SimulationState& from, double dt, StepOutcome& outcome) {
  outcome.film_iterations = 0;
  if (!begin_tissue(from, dt, outcome)) return false;
  double last_error = std::numeric_limits<double>::infinity();
  for (outcome.newton_iterations = 1; outcome.newton_iterations <= kMaxNewtonIterations; ++outcome.newton_iterations) {
    ++cost_.newton_iterations;
    const double force_tolerance = is_late(outcome) ? kForceTolerance : kPromptForceTolerance;
    find_gap_without_pressure();
    if (!solve_films(outcome)) return false;
    if (!move_tissue(from, dt, outcome)) return false;
    const double error = measure_error(force_tolerance, outcome);
    // The barrier against elements turned inside out (solid/inversion_barrier.h) drives folded ones
    // back.
    if (error <= 1.0 && outcome.min_scaled_jacobian > 0.0) {
      outcome.state.late_iterations += std::max(0, outcome.newton_iterations - kPromptIterations);
      return true;
    }
    const bool converges = error <= kLeastGain * last_error;
    last_error = error;
    if (converges || !is_late(outcome)) continue;
    if (!renew_factor(dt, outcome)) return false;
    last_error = std::numeric_limits<double>::infinity();
  }
  outcome.reason =
      outcome.min_scaled_jacobian > 0.0
          ? absl::StrCat("tissue and film are ", last_error, " times further from balance than they may be after ",
                         kMaxNewtonIterations, " iterations")
          : "a hexahedron of the tissue is turned inside out";
  return false;
}

/// Brings forces and gaps to where the step starts, and finds a factor to go with.
bool CoupledStep::begin_tissue(const SimulationState& from, double dt, StepOutcome& outcome) {
  if (!system_) {
    films_->update_walls();
    return true;
  }
  if (!take_up_factor(from, dt, outcome)) return false;
  if (films_->mobility().is_due(outcome.state)) {
    const PhaseTimer timer(cost_.times.film);
    films_->mobility().renew(solution_, outcome.state);
  }
  system_->bring_forces_to(outcome.state.positions, outcome.state.spring_is_intact, dt);
  const PhaseTimer timer(cost_.times.coupling);
  system_->evaluate_gaps(outcome.state.positions);
  forces_->compute(from, outcome.state.positions, dt, residual_);
  return true;
}

bool CoupledStep::take_up_factor(const SimulationState& from, double dt, StepOutcome& outcome) {
  if (mechanics::HeldFactor::is_due(from)) return renew_factor(dt, outcome);
  const mechanics::HeldFactor::TakenUp taken_up = factor_->take_up(from);
  if (taken_up == mechanics::HeldFactor::TakenUp::kImpossible) {
    outcome.reason = kNotDefinite;
    return false;
  }
  if (taken_up == mechanics::HeldFactor::TakenUp::kMade) {
    const PhaseTimer timer(cost_.times.factor);
    films_->update_walls();
    films_->mobility().forget();
  }
  const PhaseTimer timer(cost_.times.factor);
  films_->mobility().take_up(from);
  return true;
}

bool CoupledStep::renew_factor(double dt, StepOutcome& outcome) {
  if (!factor_->renew(dt, outcome.state)) {
    outcome.reason = kNotDefinite;
    return false;
  }
  {
    const PhaseTimer timer(cost_.times.factor);
    films_->update_walls();
  }
  const PhaseTimer timer(cost_.times.film);
  films_->mobility().renew(solution_, outcome.state);
  return true;
}

/// True when the factor at hand is of other positions than those of the iteration.
bool CoupledStep::is_late(const StepOutcome& outcome) const {
  return factor_ && factor_->is_late(outcome.state.positions);
}

/// Finds the rest volume, walls of their own apart, and on tissue the gap to which the forces alone
/// would bring it.
void CoupledStep::find_gap_without_pressure() {
  Iteration& now = iteration_;
  now.gap_without_pressure = films_->walls().rest_volume();
  if (!system_) return;
  cells_.gather_tissue_part(solution_.pressure, now.pressure);
  now.force = residual_;
  forces_->add_coupling(factor_->factor().derivative(), now.pressure, now.force);
  const PhaseTimer timer(cost_.times.solve);
  factor_->factor().solve_gap_response(now.force, now.response);
  for (size_t k = 0; k < cells_.on_tissue.size(); ++k) {
    now.gap_without_pressure[cells_.on_tissue[k]] += system_->gaps().volume()[k] + now.response[k];
  }
}

bool CoupledStep::solve_films(StepOutcome& outcome) {
  const bool converged = films_->solve(iteration_.gap_without_pressure, outcome.state, solution_);
  outcome.film_iterations += solution_.iterations;
  if (converged) return true;
  outcome.reason = absl::StrCat("the film did not converge in ", solution_.iterations, " iterations (change ",
                                solution_.change, ", least volume ", solution_.volume.minCoeff() * 1e9, " mm3 a cell)");
  return false;
}

bool CoupledStep::move_tissue(const SimulationState& from, double dt, StepOutcome& outcome) {
  if (!system_) return true;
  Iteration& now = iteration_;
  Eigen::Matrix3Xd& x = outcome.state.positions;
  cells_.gather_tissue_part(solution_.pressure, now.pressure);
  {
    const PhaseTimer timer(cost_.times.solve);
    factor_->factor().solve_displacement(now.pressure, now.displacement);
    ++cost_.tissue_solves;
  }
  system_->add_displacement(now.displacement, x);
  if (!x.allFinite()) {
    outcome.reason = "positions are not finite";
    return false;
  }
  system_->bring_forces_to(x, outcome.state.spring_is_intact, dt);
  {
    const PhaseTimer timer(cost_.times.coupling);
    system_->evaluate_gaps(x);
    forces_->compute(from, x, dt, residual_);
  }
  const PhaseTimer timer(cost_.times.element);
  outcome.min_scaled_jacobian = solid::compute_min_scaled_jacobian(system_->tissue().mesh(), x);
  return true;
}

/// Measures how far gap and forces are from where they must be, in tolerances.
double CoupledStep::measure_error(double force_tolerance, StepOutcome& outcome) {
  const PhaseTimer timer(cost_.times.coupling);
  find_gap(solution_.pressure, outcome.gap);
  const double of_gap = films_->walls().relative_gap_error(outcome.gap, solution_) / kGapTolerance;
  if (!system_) return of_gap;
  return std::max(of_gap, forces_->relative_error(residual_, iteration_.pressure) / force_tolerance);
}

/// Finds the gap of every cell where the tissue is, at a pressure of those with walls of their own.
void CoupledStep::find_gap(const Eigen::VectorXd& pressure, Eigen::VectorXd& gap) const {
  films_->walls().compute_gap_of_own_walls(pressure, gap);
  for (size_t k = 0; k < cells_.on_tissue.size(); ++k) gap[cells_.on_tissue[k]] += system_->gaps().volume()[k];
}

/// Notes velocities, and that ligaments which carry more than they can are broken from now on.
void CoupledStep::finish_tissue(const SimulationState& from, double dt, StepOutcome& outcome) {
  if (!system_) return;
  SimulationState& next = outcome.state;
  next.velocities = (next.positions - from.positions) / dt;
  next.earlier_velocities[0] = from.velocities;
  next.earlier_velocities[1] = from.earlier_velocities[0];
  next.earlier_velocities[2] = from.earlier_velocities[1];
  next.equal_steps = dt == from.last_step ? from.equal_steps + 1 : 1;
  describe_tissue(outcome, dt);
  for (const mechanics::LigamentLayout& ligament : system_->setup().ligaments) {
    for (int k = ligament.first_spring; k < ligament.first_spring + ligament.n_springs; ++k) {
      if (outcome.spring_tension[k] > ligament.breaking_force) next.spring_is_intact[k] = 0.0;
    }
  }
}

StepOutcome CoupledStep::describe(const SimulationState& state) {
  StepOutcome outcome;
  outcome.state = state;
  Eigen::VectorXd pressure;
  cells_.gather(state, &mechanics::FilmState::pressure, pressure);
  if (system_) system_->evaluate_gaps(state.positions);
  find_gap(pressure, outcome.gap);
  outcome.void_volume = films_->compute_void(state, outcome.gap);
  if (!system_) return outcome;
  outcome.min_scaled_jacobian = solid::compute_min_scaled_jacobian(system_->tissue().mesh(), state.positions);
  describe_tissue(outcome, state.last_step > 0.0 ? state.last_step : 1.0);
  return outcome;
}

/// Fills in energies and springs. The forces are those that the next step begins with.
void CoupledStep::describe_tissue(StepOutcome& outcome, double dt) {
  const SimulationState& state = outcome.state;
  const solid::Tissue& tissue = system_->tissue();
  system_->bring_forces_to(state.positions, state.spring_is_intact, dt);
  outcome.elastic_energy = tissue.elastic_energy();
  outcome.kinetic_energy = 0.5 * state.velocities.colwise().squaredNorm() * tissue.mass();
  const int n_springs = system_->n_ligament_springs();
  outcome.spring_tension.resize(n_springs);
  outcome.spring_length.resize(n_springs);
  for (int k = 0; k < n_springs; ++k) {
    outcome.spring_tension[k] = tissue.spring_tension(k);
    outcome.spring_length[k] = tissue.spring_length(k);
  }
}

}  // namespace lipofill::step
