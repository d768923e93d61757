#include "core/simulation/coupled_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/solid/hex_quality.h"

namespace lipofill::simulation {
namespace {

constexpr int kMaxNewtonIterations = 12;
/// Sum over cells of |gap - film| over the film's volume; well inside the 1e-4 that is promised.
constexpr double kGapTolerance = 2e-5;

}  // namespace

int CoupledStep::n_ligament_springs() const {
  if (!tissue_ || tissue_->ligaments.empty()) return 0;
  return tissue_->ligaments.back().first_spring + tissue_->ligaments.back().n_springs;
}

void CoupledStep::assemble(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& spring_is_intact, double dt) {
  if (dt == assembled_dt_ && spring_is_intact == assembled_springs_ && x == assembled_positions_) return;
  for (int k = 0; k < spring_is_intact.size(); ++k) tissue_->tissue.set_spring_intact(k, spring_is_intact[k] > 0.0);
  tissue_->tissue.assemble(x, dt);
  assembled_positions_ = x;
  assembled_springs_ = spring_is_intact;
  assembled_dt_ = dt;
}

bool CoupledStep::linearise_tissue(const SimulationState& state, double dt) {
  assemble(state.positions, state.spring_is_intact, dt);
  gaps_->evaluate(state.positions);
  return factor_->factorise(tissue_->tissue.system_matrix(), gaps_->derivative()).ok();
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
  Eigen::Matrix3Xd& x = outcome.state.positions;
  const Eigen::VectorXd lowest = lowest_pressure(outcome.state);
  for (outcome.newton_iterations = 1; outcome.newton_iterations <= kMaxNewtonIterations; ++outcome.newton_iterations) {
    Eigen::VectorXd gap_without_pressure = rest_volume_;
    Eigen::VectorXd force, response;
    if (tissue_) {
      if (!linearise_tissue(outcome.state, dt)) {
        outcome.reason = "the tissue's stiffness is not positive definite";
        return false;
      }
      force = compute_residual_force(from, x, dt);
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
    if (tissue_) {
      add_displacement(factor_->solve_displacement(force, response, gather_tissue_part(solution.pressure)), x);
      if (!x.allFinite()) {
        outcome.reason = "positions are not finite";
        return false;
      }
      gaps_->evaluate(x);
    }
    outcome.gap = gap_of_walls(solution.pressure);
    for (size_t k = 0; k < cell_of_tissue_.size(); ++k) outcome.gap[cell_of_tissue_[k]] += gaps_->volume()[k];
    if (gap_error(outcome.gap, solution.volume + solution.void_volume) > kGapTolerance) continue;
    if (tissue_) outcome.min_scaled_jacobian = solid::compute_min_scaled_jacobian(tissue_->tissue.mesh(), x);
    // The barrier against elements turned inside out (solid/inversion_barrier.h) drives folded ones back.
    if (outcome.min_scaled_jacobian > 0.0) return true;
  }
  if (!(outcome.min_scaled_jacobian > 0.0)) {
    outcome.reason = "a hexahedron of the tissue is turned inside out";
    return false;
  }
  outcome.reason = absl::StrCat("the gap differs from the film's volume by a share of ",
                                gap_error(outcome.gap, solution.volume + solution.void_volume), " after ",
                                kMaxNewtonIterations, " iterations");
  return false;
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

/// Energies and springs. Assembles where the next step begins.
void CoupledStep::describe_tissue(StepOutcome& outcome, double dt) {
  const SimulationState& state = outcome.state;
  const solid::Tissue& tissue = tissue_->tissue;
  assemble(state.positions, state.spring_is_intact, dt);
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
