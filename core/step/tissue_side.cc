// The tissue's side of a coupled step: its forces, its factor and how long that serves, what becomes of it.

#include <algorithm>

#include "core/solid/hex_quality.h"
#include "core/step/coupled_step.h"

namespace lipofill::step {
namespace {

/// Iterations with a factor of earlier positions, beyond those that a new one would need, that cost as much as it does.
constexpr int kLateIterationsOfAFactor = 6;
/// Share of a load that a float32 solve may leave: well below what an iteration with a factor of its own positions may.
constexpr double kFactorTolerance = 1e-3;

template <typename Matrix>
bool same(const Matrix& a, const Matrix& b) {
  return a.cols() == b.cols() && a.rows() == b.rows() && a == b;
}

}  // namespace

int CoupledStep::n_ligament_springs() const {
  if (!tissue_ || tissue_->ligaments.empty()) return 0;
  return tissue_->ligaments.back().first_spring + tissue_->ligaments.back().n_springs;
}

void CoupledStep::bring_forces_to(const mechanics::SimulationState& state, double dt) {
  if (same(state.spring_is_intact, forces_springs_) && same(state.positions, forces_positions_)) return;
  const bool damping_needs_stiffness = tissue_->tissue.damping().beta > 0.0;
  if (damping_needs_stiffness) return assemble(state, dt);
  set_springs(state);
  const PhaseTimer timer(cost_.times.element);
  tissue_->tissue.compute_force(state.positions);
}

void CoupledStep::assemble(const mechanics::SimulationState& state, double dt) {
  set_springs(state);
  tissue_->tissue.assemble(state.positions, dt);
}

void CoupledStep::set_springs(const mechanics::SimulationState& state) {
  for (int k = 0; k < state.spring_is_intact.size(); ++k) {
    tissue_->tissue.set_spring_intact(k, state.spring_is_intact[k] > 0.0);
  }
  forces_positions_ = state.positions;
  forces_springs_ = state.spring_is_intact;
}

bool CoupledStep::linearise_tissue(const mechanics::SimulationState& state, double dt, coupling::Precision precision) {
  {
    const PhaseTimer timer(cost_.times.element);
    assemble(state, dt);
  }
  {
    const PhaseTimer timer(cost_.times.coupling);
    gaps_->evaluate(state.positions);
  }
  const PhaseTimer timer(cost_.times.factor);
  factored_positions_ = state.positions;
  factored_springs_ = state.spring_is_intact;
  factored_dt_ = 0.0;
  ++cost_.factorisations;
  if (!factor_->factorise(tissue_->tissue.system_matrix(), gaps_->derivative(), precision)) return false;
  const bool is_exact = precision == coupling::Precision::kDouble || measure_factor_error() <= kFactorTolerance;
  if (!is_exact) return false;
  factored_dt_ = dt;
  factored_precision_ = precision;
  set_walls(work_.walls);
  film_solver_->pressure_solver().set_walls(work_.walls);
  return true;
}

/// In float32 as long as that has been enough.
bool CoupledStep::factor_here(double dt, mechanics::SimulationState& state) {
  bool is_factored = false;
  if (state.factored_in_double == 0) is_factored = linearise_tissue(state, dt, coupling::Precision::kSingle);
  if (!is_factored) {
    if (state.factored_in_double == 0) ++cost_.fallbacks;
    state.factored_in_double = 1;
    is_factored = linearise_tissue(state, dt, coupling::Precision::kDouble);
  }
  if (!is_factored) return false;
  state.factored_positions = factored_positions_;
  state.factored_springs = factored_springs_;
  state.factored_dt = dt;
  state.late_iterations = 0;
  return true;
}

bool CoupledStep::take_up_factor(const mechanics::SimulationState& state) {
  const auto precision = state.factored_in_double == 0 ? coupling::Precision::kSingle : coupling::Precision::kDouble;
  const bool at_hand = state.factored_dt == factored_dt_ && precision == factored_precision_ &&
                       same(state.factored_springs, factored_springs_) &&
                       same(state.factored_positions, factored_positions_);
  if (at_hand) return true;
  mechanics::SimulationState then;
  then.positions = state.factored_positions;
  then.spring_is_intact = state.factored_springs;
  if (!linearise_tissue(then, state.factored_dt, precision)) return false;
  kept_mobility_.clear();
  return true;
}

/// Preconditions pressures as the state says, unless they are so at present.
void CoupledStep::take_up_mobility(const mechanics::SimulationState& state) {
  if (!has_lagged_mobility_) return;
  bool is_at_hand = kept_mobility_.size() == state.films.size();
  for (size_t f = 0; is_at_hand && f < state.films.size(); ++f) {
    is_at_hand = same(kept_mobility_[f], state.films[f].factored_mobility);
  }
  if (!is_at_hand) keep_mobility(state);
}

/// Preconditions the pressures of many cells with the mobility that the state holds.
void CoupledStep::keep_mobility(const mechanics::SimulationState& state) {
  const PhaseTimer timer(cost_.times.factor);
  kept_mobility_.resize(state.films.size());
  for (size_t f = 0; f < state.films.size(); ++f) kept_mobility_[f] = state.films[f].factored_mobility;
  film_solver_->pressure_solver().keep_mobility(kept_mobility_);
}

/// force + (B(x) - B0)^T p
void CoupledStep::add_coupling_force(const Eigen::VectorXd& pressure, Eigen::VectorXd& force) {
  work_.of_films.noalias() = gaps_->derivative().transpose() * pressure;
  force += work_.of_films;
  work_.of_films.noalias() = factor_->derivative().transpose() * pressure;
  force -= work_.of_films;
}

/// What is out of balance, f + B^T p, over what is in it.
double CoupledStep::force_error(const Eigen::VectorXd& force, const Eigen::VectorXd& pressure) {
  work_.of_films.noalias() = gaps_->derivative().transpose() * pressure;
  const double scale = work_.of_films.norm() + tissue_->tissue.internal_force().norm() + least_force_;
  return (force + work_.of_films).norm() / scale;
}

/// Weight - f_int - M (x - x_n - dt v_n)/dt^2 - D (x - x_n)/dt, a value a degree of freedom.
void CoupledStep::compute_residual_force(const mechanics::SimulationState& from, const Eigen::Matrix3Xd& x, double dt,
                                         Eigen::VectorXd& force) {
  const solid::Tissue& tissue = tissue_->tissue;
  const double alpha = tissue.damping().alpha;
  const double beta = tissue.damping().beta;
  const std::vector<int>& dofs = tissue.dof_of_component();
  force = -tissue.internal_force();
  Eigen::VectorXd& moved = work_.moved;
  moved.resize(tissue.n_dofs());
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
}

void CoupledStep::add_displacement(const Eigen::VectorXd& dx, Eigen::Matrix3Xd& x) const {
  const std::vector<int>& dofs = tissue_->tissue.dof_of_component();
  for (size_t k = 0; k < dofs.size(); ++k) {
    if (dofs[k] >= 0) x.data()[k] += dx[dofs[k]];
  }
}

/// Forces and gap at the start, and a factor to go with.
bool CoupledStep::begin_tissue_step(const mechanics::SimulationState& from, double dt, StepOutcome& outcome,
                                    const coupling::FilmSolution& start) {
  if (!tissue_) {
    set_walls(work_.walls);
    film_solver_->pressure_solver().set_walls(work_.walls);
    return true;
  }
  const bool is_due = from.factored_dt == 0.0 || from.late_iterations >= kLateIterationsOfAFactor;
  if (is_due) {
    if (!renew_factor(dt, outcome, start)) return false;
  } else if (!take_up_factor(from)) {
    outcome.reason = "the tissue's stiffness is not positive definite";
    return false;
  }
  if (!is_due) take_up_mobility(from);
  const bool is_mobility_due =
      has_lagged_mobility_ &&
      outcome.state.late_pressure_iterations > film_solver_->pressure_solver().iterations_of_a_preconditioner();
  if (is_mobility_due) renew_mobility(outcome.state, start);
  bring_forces_to(outcome.state, dt);
  const PhaseTimer timer(cost_.times.coupling);
  gaps_->evaluate(outcome.state.positions);
  compute_residual_force(from, outcome.state.positions, dt, force_);
  return true;
}

bool CoupledStep::renew_factor(double dt, StepOutcome& outcome, const coupling::FilmSolution& at) {
  if (!factor_here(dt, outcome.state)) {
    outcome.reason = "the tissue's stiffness is not positive definite";
    return false;
  }
  if (has_lagged_mobility_) renew_mobility(outcome.state, at);
  return true;
}

void CoupledStep::renew_mobility(mechanics::SimulationState& state, const coupling::FilmSolution& at) {
  {
    const PhaseTimer timer(cost_.times.film);
    film_solver_->measure_mobility(at, work_.mobility);
  }
  for (size_t f = 0; f < films_.size(); ++f) state.films[f].factored_mobility = work_.mobility[f];
  state.late_pressure_iterations = 0;
  keep_mobility(state);
}

/// What a solve under a load that bends and shears all there is, pressure in every film and weight, leaves of the load.
double CoupledStep::measure_factor_error() {
  const solid::Tissue& tissue = tissue_->tissue;
  Eigen::VectorXd& load = work_.force;
  Eigen::VectorXd& weight = work_.moved;
  work_.pressure.setOnes(gaps_->volume().size());
  load.noalias() = gaps_->derivative().transpose() * work_.pressure;
  weight.setZero(load.size());
  for (size_t k = 0; k < tissue.dof_of_component().size(); ++k) {
    if (tissue.dof_of_component()[k] >= 0) weight[tissue.dof_of_component()[k]] = tissue.mass()[k / 3];
  }
  const double pressure_size = load.norm();
  if (weight.norm() > 0.0) load += (pressure_size > 0.0 ? pressure_size : 1.0) / weight.norm() * weight;
  factor_->solve_gap_response(load, work_.response);
  work_.pressure.setZero();
  factor_->solve_displacement(work_.pressure, work_.displacement);
  Eigen::VectorXd& left = work_.of_films;
  left = -load;
  left.noalias() += tissue.system_matrix().selfadjointView<Eigen::Lower>() * work_.displacement;
  return left.norm() / load.norm();
}

/// Whether the factor at hand is of other positions than those of the iteration.
bool CoupledStep::is_late(const StepOutcome& outcome) const {
  return !same(factored_positions_, outcome.state.positions);
}

bool CoupledStep::move_tissue(const mechanics::SimulationState& from, double dt, const Eigen::VectorXd& pressure,
                              StepOutcome& outcome) {
  Eigen::Matrix3Xd& x = outcome.state.positions;
  {
    const PhaseTimer timer(cost_.times.solve);
    factor_->solve_displacement(pressure, work_.displacement);
    ++cost_.tissue_solves;
  }
  add_displacement(work_.displacement, x);
  if (!x.allFinite()) {
    outcome.reason = "positions are not finite";
    return false;
  }
  bring_forces_to(outcome.state, dt);
  {
    const PhaseTimer timer(cost_.times.coupling);
    gaps_->evaluate(x);
    compute_residual_force(from, x, dt, force_);
  }
  const PhaseTimer timer(cost_.times.element);
  outcome.min_scaled_jacobian = solid::compute_min_scaled_jacobian(tissue_->tissue.mesh(), x);
  return true;
}

/// Ligaments that carry more than they can are broken from now on.
void CoupledStep::finish_tissue(const mechanics::SimulationState& from, double dt, StepOutcome& outcome) {
  if (!tissue_) return;
  mechanics::SimulationState& next = outcome.state;
  next.velocities = (next.positions - from.positions) / dt;
  next.earlier_velocities[0] = from.velocities;
  next.earlier_velocities[1] = from.earlier_velocities[0];
  next.earlier_velocities[2] = from.earlier_velocities[1];
  next.equal_steps = dt == from.last_step ? from.equal_steps + 1 : 1;
  describe_tissue(outcome, dt);
  for (const mechanics::LigamentLayout& ligament : tissue_->ligaments) {
    for (int k = ligament.first_spring; k < ligament.first_spring + ligament.n_springs; ++k) {
      if (outcome.spring_tension[k] > ligament.breaking_force) next.spring_is_intact[k] = 0.0;
    }
  }
}

/// Energies and springs. The forces are those that the next step begins with.
void CoupledStep::describe_tissue(StepOutcome& outcome, double dt) {
  const mechanics::SimulationState& state = outcome.state;
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

}  // namespace lipofill::step
