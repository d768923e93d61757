#include "core/step/coupled_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/solid/hex_quality.h"
#include "core/step/step_start.h"

namespace lipofill::step {
namespace {

constexpr int kMaxNewtonIterations = 16;
/// Forces out of balance over forces in balance, after an iteration with a factor of earlier positions; and after one
/// with a factor of its own, whose error is of second order.
constexpr double kForceTolerance = 1e-3;
constexpr double kPromptForceTolerance = 1e-2;
/// An iteration that leaves more of the error than this calls for a new factor.
constexpr double kLeastGain = 0.3;
/// Iterations of a step that a new factor would need too.
constexpr int kPromptIterations = 2;
/// Iterations of conjugate gradients that a solve with an up-to-date preconditioner would need too.
constexpr int kPromptPressureIterations = 2;
/// Equal steps after which films are carried on along a parabola: before that, not all began in the same way.
constexpr int kStepsOfACurve = 3;
/// Sum over cells of |gap - film| over the film's volume; well inside the 1e-4 that is promised.
constexpr double kGapTolerance = 2e-5;

}  // namespace

void CoupledStep::gather_tissue_part(const Eigen::VectorXd& all_cells, Eigen::VectorXd& part) const {
  part.resize(static_cast<Eigen::Index>(cell_of_tissue_.size()));
  for (size_t k = 0; k < cell_of_tissue_.size(); ++k) part[k] = all_cells[cell_of_tissue_[k]];
}

/// Of the gap against film and void together.
double CoupledStep::gap_error(const Eigen::VectorXd& gap, const coupling::FilmSolution& solution) const {
  const auto held = solution.volume + solution.void_volume;
  const double total = std::max(held.sum(), std::numeric_limits<double>::min());
  if (coupling_ == plan::CouplingMode::kLumped) return std::abs((gap - held).sum()) / total;
  return (gap - held).cwiseAbs().sum() / total;
}

void CoupledStep::gather(const mechanics::SimulationState& state, Eigen::VectorXd mechanics::FilmState::*values,
                         Eigen::VectorXd& all) const {
  all.resize(cell_offset_.back());
  for (size_t f = 0; f < films_.size(); ++f) {
    all.segment(cell_offset_[f], films_[f].grid.n_cells()) = state.films[f].*values;
  }
}

void CoupledStep::try_step(const mechanics::SimulationState& state, const std::vector<Eigen::VectorXd>& injected,
                           double dt, StepOutcome& outcome) {
  outcome.accepted = false;
  outcome.reason.clear();
  outcome.state = state;
  enter_injected_cells(injected, outcome.state);
  {
    const PhaseTimer timer(cost_.times.film);
    begin_film_step(outcome.state, injected, dt);
  }
  coupling::FilmSolution& solution = work_.solution;
  predict(state, dt, outcome.state, solution);
  if (!solve_tissue_and_films(state, dt, outcome, solution)) return;
  outcome.void_volume = solution.void_volume;
  finish_tissue(state, dt, outcome);
  const PhaseTimer timer(cost_.times.film);
  finish_films(state, dt, solution, outcome.state);
  outcome.state.time = state.time + dt;
  outcome.state.step = state.step + 1;
  outcome.state.last_step = dt;
  outcome.accepted = true;
}

/// Of every cell in the next step: as it changed in the last one, after steps of its size.
void CoupledStep::predict_rate(const mechanics::SimulationState& from, double dt,
                               Eigen::VectorXd mechanics::FilmState::*last,
                               Eigen::VectorXd mechanics::FilmState::*before, Eigen::VectorXd& rate) {
  gather(from, last, rate);
  const bool is_one_size = from.equal_steps >= kStepsOfACurve && dt == from.last_step;
  if (!is_one_size) return;
  gather(from, before, work_.earlier_rate);
  rate += rate - work_.earlier_rate;
}

/// Carries the last steps on: where the iteration starts.
void CoupledStep::predict(const mechanics::SimulationState& from, double dt, mechanics::SimulationState& next,
                          coupling::FilmSolution& solution) {
  gather(from, &mechanics::FilmState::pressure, solution.pressure);
  predict_rate(from, dt, &mechanics::FilmState::pressure_rate, &mechanics::FilmState::earlier_pressure_rate,
               work_.rate);
  solution.pressure += dt * work_.rate;
  gather(from, &mechanics::FilmState::volume, solution.volume);
  predict_rate(from, dt, &mechanics::FilmState::volume_rate, &mechanics::FilmState::earlier_volume_rate, work_.rate);
  solution.volume = (solution.volume + dt * work_.rate).cwiseMax(0.0);
  solution.flux.resize(from.films.size());
  for (size_t f = 0; f < from.films.size(); ++f) {
    const Eigen::VectorXd& velocity = from.films[f].velocity;
    solution.flux[f].setZero(velocity.size() + static_cast<Eigen::Index>(films_[f].grid.leaky_walls.size()));
    solution.flux[f].head(velocity.size()) = velocity;
  }
  if (!tissue_ || from.velocities.isZero(0.0)) return;
  predict_positions(from, dt, next.positions);
  bring_forces_to(next, dt);
  if (tissue_->tissue.min_volume_ratio() <= 0.0) next.positions = from.positions;
}

bool CoupledStep::solve_films(StepOutcome& outcome, coupling::FilmSolution& solution) {
  const PhaseTimer timer(cost_.times.film);
  const coupling::PressureSolver& pressures = film_solver_->pressure_solver();
  const long solves = pressures.iterative_solves();
  const long iterations = pressures.iterations();
  const long fallbacks = pressures.fallbacks();
  film_solver_->solve(work_.gap_without_pressure, work_.lowest, film_tolerance(), solution);
  const auto spent = static_cast<int>(pressures.iterations() - iterations);
  const auto prompt = kPromptPressureIterations * static_cast<int>(pressures.iterative_solves() - solves);
  cost_.iterative_iterations += spent;
  outcome.state.late_pressure_iterations += std::max(0, spent - prompt);
  cost_.fallbacks += static_cast<int>(pressures.fallbacks() - fallbacks);
  cost_.film_iterations += solution.iterations;
  outcome.film_iterations += solution.iterations;
  if (solution.converged) return true;
  outcome.reason = absl::StrCat("the film did not converge in ", solution.iterations, " iterations (change ",
                                solution.change, ", least volume ", solution.volume.minCoeff() * 1e9, " mm3 a cell)");
  return false;
}

/// Rest, walls of their own apart, and on tissue where the force there is alone would bring the gap.
void CoupledStep::set_gap_without_pressure(const coupling::FilmSolution& solution) {
  work_.gap_without_pressure = rest_volume_;
  if (!tissue_) return;
  gather_tissue_part(solution.pressure, work_.pressure);
  work_.force = force_;
  add_coupling_force(work_.pressure, work_.force);
  const PhaseTimer timer(cost_.times.solve);
  factor_->solve_gap_response(work_.force, work_.response);
  for (size_t k = 0; k < cell_of_tissue_.size(); ++k) {
    work_.gap_without_pressure[cell_of_tissue_[k]] += gaps_->volume()[k] + work_.response[k];
  }
}

bool CoupledStep::solve_tissue_and_films(const mechanics::SimulationState& from, double dt, StepOutcome& outcome,
                                         coupling::FilmSolution& solution) {
  set_lowest_pressure(outcome.state, work_.lowest);
  outcome.film_iterations = 0;
  if (!begin_tissue_step(from, dt, outcome, solution)) return false;
  double last_error = std::numeric_limits<double>::infinity();
  for (outcome.newton_iterations = 1; outcome.newton_iterations <= kMaxNewtonIterations; ++outcome.newton_iterations) {
    ++cost_.newton_iterations;
    const double force_tolerance = tissue_ && is_late(outcome) ? kForceTolerance : kPromptForceTolerance;
    set_gap_without_pressure(solution);
    if (!solve_films(outcome, solution)) return false;
    gather_tissue_part(solution.pressure, work_.pressure);
    if (tissue_ && !move_tissue(from, dt, work_.pressure, outcome)) return false;
    const double error = measure_error(solution, force_tolerance, outcome);
    // The barrier against elements turned inside out (solid/inversion_barrier.h) drives folded ones back.
    if (error <= 1.0 && outcome.min_scaled_jacobian > 0.0) {
      outcome.state.late_iterations += std::max(0, outcome.newton_iterations - kPromptIterations);
      return true;
    }
    const bool converges = error <= kLeastGain * last_error;
    last_error = error;
    if (!tissue_ || converges || !is_late(outcome)) continue;
    if (!renew_factor(dt, outcome, solution)) return false;
    last_error = std::numeric_limits<double>::infinity();
  }
  outcome.reason =
      outcome.min_scaled_jacobian > 0.0
          ? absl::StrCat("tissue and film are ", last_error, " times further from balance than they may be after ",
                         kMaxNewtonIterations, " iterations")
          : "a hexahedron of the tissue is turned inside out";
  return false;
}

/// How far gap and forces are from where they must be, in tolerances.
double CoupledStep::measure_error(const coupling::FilmSolution& solution, double force_tolerance,
                                  StepOutcome& outcome) {
  const PhaseTimer timer(cost_.times.coupling);
  set_gap_of_walls(solution.pressure, outcome.gap);
  if (!tissue_) return gap_error(outcome.gap, solution) / kGapTolerance;
  for (size_t k = 0; k < cell_of_tissue_.size(); ++k) outcome.gap[cell_of_tissue_[k]] += gaps_->volume()[k];
  const double of_gap = gap_error(outcome.gap, solution) / kGapTolerance;
  return std::max(of_gap, force_error(force_, work_.pressure) / force_tolerance);
}

void CoupledStep::compute_gap(const mechanics::SimulationState& state, Eigen::VectorXd& gap) {
  gather(state, &mechanics::FilmState::pressure, work_.rate);
  set_gap_of_walls(work_.rate, gap);
  if (!tissue_) return;
  gaps_->evaluate(state.positions);
  for (size_t k = 0; k < cell_of_tissue_.size(); ++k) gap[cell_of_tissue_[k]] += gaps_->volume()[k];
}

StepOutcome CoupledStep::describe(const mechanics::SimulationState& state) {
  StepOutcome outcome;
  outcome.state = state;
  compute_gap(state, outcome.gap);
  Eigen::VectorXd pressure, volume, lowest;
  gather(state, &mechanics::FilmState::pressure, pressure);
  gather(state, &mechanics::FilmState::volume, volume);
  set_lowest_pressure(state, lowest);
  outcome.void_volume = Eigen::VectorXd::Zero(outcome.gap.size());
  if (lowest.size() > 0) {
    const Eigen::VectorXd excess = (outcome.gap - volume).cwiseMax(0.0);
    outcome.void_volume = (pressure.array() <= lowest.array()).select(excess, 0.0);
  }
  if (!tissue_) return outcome;
  outcome.min_scaled_jacobian = solid::compute_min_scaled_jacobian(tissue_->tissue.mesh(), state.positions);
  describe_tissue(outcome, state.last_step > 0.0 ? state.last_step : 1.0);
  return outcome;
}

}  // namespace lipofill::step
