// The tissue's side of a coupled step: its forces, its factor and how long that serves, what becomes of it.

#include <algorithm>

#include "core/simulation/coupled_step.h"
#include "core/solid/hex_quality.h"

namespace lipofill::simulation {
namespace {

/// Iterations with a factor of earlier positions, beyond those that a new one would need, that cost as much as it does.
constexpr int kLateIterationsOfAFactor = 6;

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
  const double scale = of_films.norm() + tissue_->tissue.internal_force().norm() + least_force_;
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

void CoupledStep::add_displacement(const Eigen::VectorXd& dx, Eigen::Matrix3Xd& x) const {
  const std::vector<int>& dofs = tissue_->tissue.dof_of_component();
  for (size_t k = 0; k < dofs.size(); ++k) {
    if (dofs[k] >= 0) x.data()[k] += dx[dofs[k]];
  }
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

}  // namespace lipofill::simulation
