#include "core/simulation/coupled_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/solid/hex_quality.h"

namespace lipofill::simulation {
namespace {

constexpr int kMaxNewtonIterations = 16;
/// Forces out of balance over forces in balance, after an iteration with a factor of earlier positions; and after one
/// with a factor of its own, whose error is of second order.
constexpr double kForceTolerance = 1e-3;
constexpr double kPromptForceTolerance = 1e-2;
/// An iteration that leaves more of the error than this calls for a new factor.
constexpr double kLeastGain = 0.3;
/// Iterations of a step that a new factor would need too, and how many more cost as much as a factor does.
constexpr int kPromptIterations = 2;
constexpr int kLateIterationsOfAFactor = 6;
/// Sum over cells of |gap - film| over the film's volume; well inside the 1e-4 that is promised.
constexpr double kGapTolerance = 2e-5;

template <typename Matrix>
bool same(const Matrix& a, const Matrix& b) {
  return a.cols() == b.cols() && a.rows() == b.rows() && a == b;
}

}  // namespace

int CoupledStep::n_ligament_springs() const {
  if (!tissue_ || tissue_->ligaments.empty()) return 0;
  return tissue_->ligaments.back().first_spring + tissue_->ligaments.back().n_springs;
}

void CoupledStep::bring_forces_to(const SimulationState& state, double dt) {
  if (same(state.spring_is_intact, forces_springs_) && same(state.positions, forces_positions_)) return;
  const bool damping_needs_stiffness = tissue_->tissue.damping().beta > 0.0;
  if (damping_needs_stiffness) return assemble(state, dt);
  set_springs(state);
  tissue_->tissue.compute_force(state.positions);
}

void CoupledStep::assemble(const SimulationState& state, double dt) {
  set_springs(state);
  tissue_->tissue.assemble(state.positions, dt);
}

void CoupledStep::set_springs(const SimulationState& state) {
  for (int k = 0; k < state.spring_is_intact.size(); ++k) {
    tissue_->tissue.set_spring_intact(k, state.spring_is_intact[k] > 0.0);
  }
  forces_positions_ = state.positions;
  forces_springs_ = state.spring_is_intact;
}

bool CoupledStep::linearise_tissue(const SimulationState& state, double dt) {
  assemble(state, dt);
  gaps_->evaluate(state.positions);
  factored_positions_ = state.positions;
  factored_springs_ = state.spring_is_intact;
  factored_dt_ = 0.0;
  if (!factor_->factorise(tissue_->tissue.system_matrix(), gaps_->derivative()).ok()) return false;
  factored_dt_ = dt;
  factored_derivative_ = gaps_->derivative();
  return true;
}

bool CoupledStep::factor_here(double dt, SimulationState& state) {
  if (!linearise_tissue(state, dt)) return false;
  state.factored_positions = factored_positions_;
  state.factored_springs = factored_springs_;
  state.factored_dt = dt;
  state.late_iterations = 0;
  return true;
}

bool CoupledStep::take_up_factor(const SimulationState& state) {
  const bool at_hand = state.factored_dt == factored_dt_ && same(state.factored_springs, factored_springs_) &&
                       same(state.factored_positions, factored_positions_);
  if (at_hand) return true;
  SimulationState then;
  then.positions = state.factored_positions;
  then.spring_is_intact = state.factored_springs;
  return linearise_tissue(then, state.factored_dt);
}

/// (B(x) - B0)^T p
Eigen::VectorXd CoupledStep::coupling_force(const Eigen::VectorXd& pressure) const {
  return gaps_->derivative().transpose() * pressure - factored_derivative_.transpose() * pressure;
}

/// What is out of balance, f + B^T p, over what is in it.
double CoupledStep::force_error(const Eigen::VectorXd& force, const Eigen::VectorXd& pressure) const {
  const Eigen::VectorXd of_films = gaps_->derivative().transpose() * pressure;
  const double scale = of_films.norm() + tissue_->tissue.internal_force().norm() + force_round_off_ / kForceTolerance;
  return (force + of_films).norm() / scale;
}

/// Weight - f_int - M (x - x_n - dt v_n)/dt^2 - D (x - x_n)/dt, a value a degree of freedom.
Eigen::VectorXd CoupledStep::compute_residual_force(const SimulationState& from, const Eigen::Matrix3Xd& x,
                                                    double dt) const {
  const solid::Tissue& tissue = tissue_->tissue;
  const double alpha = tissue.damping().alpha;
  const double beta = tissue.damping().beta;
  const std::vector<int>& dofs = tissue.dof_of_component();
  Eigen::VectorXd force = -tissue.internal_force();
  Eigen::VectorXd moved(tissue.n_dofs());
  for (size_t k = 0; k < dofs.size(); ++k) {
    if (dofs[k] < 0) continue;
    const auto node = static_cast<Eigen::Index>(k / 3);
    const auto c = static_cast<Eigen::Index>(k % 3);
    const double mass = tissue.mass()[node];
    const double step = x(c, node) - from.positions(c, node);
    moved[dofs[k]] = step;
    force[dofs[k]] += mass * (gravity_[c] - (step - dt * from.velocities(c, node)) / (dt * dt) - alpha * step / dt);
  }
  if (beta > 0.0) force -= (beta / dt) * tissue.stiffness_times(moved);
  return force;
}

Eigen::VectorXd CoupledStep::gather_tissue_part(const Eigen::VectorXd& all_cells) const {
  Eigen::VectorXd part(cell_of_tissue_.size());
  for (size_t k = 0; k < cell_of_tissue_.size(); ++k) part[k] = all_cells[cell_of_tissue_[k]];
  return part;
}

void CoupledStep::add_displacement(const Eigen::VectorXd& dx, Eigen::Matrix3Xd& x) const {
  const std::vector<int>& dofs = tissue_->tissue.dof_of_component();
  for (size_t k = 0; k < dofs.size(); ++k) {
    if (dofs[k] >= 0) x.data()[k] += dx[dofs[k]];
  }
}

double CoupledStep::gap_error(const Eigen::VectorXd& gap, const Eigen::VectorXd& volume) const {
  const double total = std::max(volume.sum(), std::numeric_limits<double>::min());
  if (coupling_ == CouplingMode::kLumped) return std::abs((gap - volume).sum()) / total;
  return (gap - volume).cwiseAbs().sum() / total;
}

Eigen::VectorXd CoupledStep::gather(const SimulationState& state, Eigen::VectorXd FilmState::*values) const {
  Eigen::VectorXd all(cell_offset_.back());
  for (size_t f = 0; f < films_.size(); ++f) {
    all.segment(cell_offset_[f], films_[f].grid.n_cells()) = state.films[f].*values;
  }
  return all;
}

StepOutcome CoupledStep::try_step(const SimulationState& state, const std::vector<Eigen::VectorXd>& injected,
                                  double dt) {
  StepOutcome outcome;
  outcome.state = state;
  enter_injected_cells(injected, outcome.state);
  begin_film_step(outcome.state, injected, dt);
  coupling::FilmSolveResult solution;
  solution.pressure = gather(state, &FilmState::pressure);
  solution.volume = gather(state, &FilmState::volume);
  for (const FilmState& film : state.films) solution.flux.push_back(film.velocity);
  if (!solve_tissue_and_films(state, dt, outcome, solution)) return outcome;
  outcome.void_volume = solution.void_volume;
  finish_tissue(state, dt, outcome);
  finish_films(state, dt, solution, outcome.state);
  outcome.state.time = state.time + dt;
  outcome.state.step = state.step + 1;
  outcome.state.last_step = dt;
  outcome.accepted = true;
  return outcome;
}

bool CoupledStep::solve_tissue_and_films(const SimulationState& from, double dt, StepOutcome& outcome,
                                         coupling::FilmSolveResult& solution) {
  std::vector<film::FilmProjection*> projections;
  for (const auto& projection : projections_) projections.push_back(projection.get());
  const Eigen::VectorXd lowest = lowest_pressure(outcome.state);
  if (!begin_tissue_step(from, dt, outcome)) return false;
  double last_error = std::numeric_limits<double>::infinity();
  for (outcome.newton_iterations = 1; outcome.newton_iterations <= kMaxNewtonIterations; ++outcome.newton_iterations) {
    const double force_tolerance = tissue_ && is_late(outcome) ? kForceTolerance : kPromptForceTolerance;
    const Eigen::VectorXd pressure = gather_tissue_part(solution.pressure);
    Eigen::VectorXd gap_without_pressure = rest_volume_;
    Eigen::VectorXd force, response;
    if (tissue_) {
      force = force_ + coupling_force(pressure);
      response = factor_->compute_gap_response(force);
      for (size_t k = 0; k < cell_of_tissue_.size(); ++k) {
        gap_without_pressure[cell_of_tissue_[k]] += gaps_->volume()[k] + response[k];
      }
    }
    solution = coupling::solve_films(projections, wall_compliance(), gap_without_pressure, lowest, solution);
    outcome.film_iterations += solution.iterations;
    if (!solution.converged) {
      outcome.reason =
          absl::StrCat("the film did not converge in ", solution.iterations, " iterations (change ", solution.change,
                       ", least volume ", solution.volume.minCoeff() * 1e9, " mm3 a cell)");
      return false;
    }
    if (tissue_ &&
        !move_tissue(from, dt, factor_->solve_displacement(force, response, gather_tissue_part(solution.pressure)),
                     outcome)) {
      return false;
    }
    const double error = measure_error(solution, force_tolerance, outcome);
    // The barrier against elements turned inside out (solid/inversion_barrier.h) drives folded ones back.
    if (error <= 1.0 && outcome.min_scaled_jacobian > 0.0) {
      outcome.state.late_iterations += std::max(0, outcome.newton_iterations - kPromptIterations);
      return true;
    }
    const bool converges = error <= kLeastGain * last_error;
    last_error = error;
    if (!tissue_ || converges || !is_late(outcome)) continue;
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

/// Forces and gap at the start, and a factor to go with.
bool CoupledStep::begin_tissue_step(const SimulationState& from, double dt, StepOutcome& outcome) {
  if (!tissue_) return true;
  const bool is_due = from.factored_dt == 0.0 || from.late_iterations >= kLateIterationsOfAFactor;
  if (is_due) {
    if (!renew_factor(dt, outcome)) return false;
  } else if (!take_up_factor(from)) {
    outcome.reason = "the tissue's stiffness is not positive definite";
    return false;
  }
  bring_forces_to(outcome.state, dt);
  gaps_->evaluate(outcome.state.positions);
  force_ = compute_residual_force(from, outcome.state.positions, dt);
  return true;
}

bool CoupledStep::renew_factor(double dt, StepOutcome& outcome) {
  ++outcome.factorisations;
  if (factor_here(dt, outcome.state)) return true;
  outcome.reason = "the tissue's stiffness is not positive definite";
  return false;
}

/// Whether the factor at hand is of other positions than those of the iteration.
bool CoupledStep::is_late(const StepOutcome& outcome) const {
  return !same(factored_positions_, outcome.state.positions);
}

bool CoupledStep::move_tissue(const SimulationState& from, double dt, const Eigen::VectorXd& dx, StepOutcome& outcome) {
  Eigen::Matrix3Xd& x = outcome.state.positions;
  add_displacement(dx, x);
  if (!x.allFinite()) {
    outcome.reason = "positions are not finite";
    return false;
  }
  bring_forces_to(outcome.state, dt);
  gaps_->evaluate(x);
  force_ = compute_residual_force(from, x, dt);
  outcome.min_scaled_jacobian = solid::compute_min_scaled_jacobian(tissue_->tissue.mesh(), x);
  return true;
}

/// How far gap and forces are from where they must be, in tolerances.
double CoupledStep::measure_error(const coupling::FilmSolveResult& solution, double force_tolerance,
                                  StepOutcome& outcome) const {
  outcome.gap = gap_of_walls(solution.pressure);
  if (!tissue_) return gap_error(outcome.gap, solution.volume + solution.void_volume) / kGapTolerance;
  for (size_t k = 0; k < cell_of_tissue_.size(); ++k) outcome.gap[cell_of_tissue_[k]] += gaps_->volume()[k];
  const double of_gap = gap_error(outcome.gap, solution.volume + solution.void_volume) / kGapTolerance;
  return std::max(of_gap, force_error(force_, gather_tissue_part(solution.pressure)) / force_tolerance);
}

/// Ligaments that carry more than they can are broken from now on.
void CoupledStep::finish_tissue(const SimulationState& from, double dt, StepOutcome& outcome) {
  if (!tissue_) return;
  SimulationState& next = outcome.state;
  next.velocities = (next.positions - from.positions) / dt;
  describe_tissue(outcome, dt);
  for (const LigamentLayout& ligament : tissue_->ligaments) {
    for (int k = ligament.first_spring; k < ligament.first_spring + ligament.n_springs; ++k) {
      if (outcome.spring_tension[k] > ligament.breaking_force) next.spring_is_intact[k] = 0.0;
    }
  }
}

/// Energies and springs. The forces are those that the next step begins with.
void CoupledStep::describe_tissue(StepOutcome& outcome, double dt) {
  const SimulationState& state = outcome.state;
  const solid::Tissue& tissue = tissue_->tissue;
  bring_forces_to(state, dt);
  outcome.elastic_energy = tissue.elastic_energy();
  outcome.kinetic_energy = 0.5 * state.velocities.colwise().squaredNorm() * tissue.mass();
  outcome.spring_tension.resize(n_ligament_springs());
  outcome.spring_length.resize(n_ligament_springs());
  for (int k = 0; k < n_ligament_springs(); ++k) {
    outcome.spring_tension[k] = tissue.spring_tension(k);
    outcome.spring_length[k] = tissue.spring_length(k);
  }
}

Eigen::VectorXd CoupledStep::compute_gap(const SimulationState& state) {
  Eigen::VectorXd gap = gap_of_walls(gather(state, &FilmState::pressure));
  if (!tissue_) return gap;
  gaps_->evaluate(state.positions);
  for (size_t k = 0; k < cell_of_tissue_.size(); ++k) gap[cell_of_tissue_[k]] += gaps_->volume()[k];
  return gap;
}

StepOutcome CoupledStep::describe(const SimulationState& state) {
  StepOutcome outcome;
  outcome.state = state;
  outcome.gap = compute_gap(state);
  const Eigen::VectorXd pressure = gather(state, &FilmState::pressure);
  const Eigen::VectorXd lowest = lowest_pressure(state);
  outcome.void_volume = Eigen::VectorXd::Zero(outcome.gap.size());
  if (lowest.size() > 0) {
    const Eigen::VectorXd excess = (outcome.gap - gather(state, &FilmState::volume)).cwiseMax(0.0);
    outcome.void_volume = (pressure.array() <= lowest.array()).select(excess, 0.0);
  }
  if (!tissue_) return outcome;
  outcome.min_scaled_jacobian = solid::compute_min_scaled_jacobian(tissue_->tissue.mesh(), state.positions);
  describe_tissue(outcome, state.last_step > 0.0 ? state.last_step : 1.0);
  return outcome;
}

}  // namespace lipofill::simulation
