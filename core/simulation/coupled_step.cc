#include "core/simulation/coupled_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/film/advection.h"
#include "core/film/edge_operators.h"
#include "core/film/edge_thickness.h"
#include "core/solid/hex_quality.h"

namespace lipofill::simulation {
namespace {

constexpr int kMaxNewtonIterations = 12;
/// Sum over cells of |gap - film| over the film's volume; well inside the 1e-4 that is promised.
constexpr double kGapTolerance = 2e-5;
/// C has negative entries on curved layers; a lumped cell keeps at least this share of its own compliance, so that J +
/// R stays definite.
constexpr double kLeastLumpedShare = 1e-3;

film::Fat fat_in(const FilmLayout& film, double viscosity, double density) {
  return {viscosity, density, film.wall_friction};
}

}  // namespace

film::FilmMetric CoupledStep::film_metric(const SimulationState& state, int film) const {
  if (gap_of_film_[film] < 0) return rest_metric_[film];
  return film::compute_film_metric(films_[film].grid, gaps_->film(gap_of_film_[film]).mid_surface(state.positions));
}

bool CoupledStep::linearise_tissue(const Eigen::Matrix3Xd& x, double dt) {
  tissue_->tissue.assemble(x, dt);
  gaps_->evaluate(x);
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

void CoupledStep::begin_film_step(const SimulationState& state, const std::vector<Eigen::VectorXd>& injected,
                                  double dt) {
  metric_.resize(films_.size());
  for (size_t f = 0; f < films_.size(); ++f) {
    const FilmState& film = state.films[f];
    const film::FilmGrid& grid = films_[f].grid;
    const film::Fat fat = fat_in(films_[f], fat_viscosity_, fat_density_);
    metric_[f] = film_metric(state, static_cast<int>(f));
    const Eigen::VectorXd h = film.volume.cwiseMax(0.0).cwiseQuotient(metric_[f].area);
    const Eigen::VectorXd edge_h = film::compute_edge_thickness(grid, h, film.velocity);
    const Eigen::VectorXd viscous = viscosity_[f].advance(grid, metric_[f], fat, h, edge_h, film.velocity, dt);
    const Eigen::VectorXd height = (gravity_.transpose() * metric_[f].centre).transpose();
    projections_[f]->begin_step({&metric_[f], fat, film.volume, injected[f],
                                 film::advect_velocity(grid, metric_[f], viscous, dt),
                                 fat_density_ * film::compute_edge_difference(grid, height), dt});
  }
}

/// The compliance of every cell's walls, in the order of all cells.
coupling::WallCompliance CoupledStep::wall_compliance() {
  coupling::WallCompliance walls;
  walls.diagonal.setZero(cell_offset_.back());
  for (size_t f = 0; f < films_.size(); ++f) {
    if (films_[f].wall != FilmWallKind::kWinkler) continue;
    walls.diagonal.segment(cell_offset_[f], films_[f].grid.n_cells()) = rest_area_[f] / films_[f].wall_stiffness;
  }
  if (cell_of_tissue_.empty()) return walls;
  const Eigen::MatrixXd& c = factor_->compliance();
  if (coupling_ == CouplingMode::kLumped) {
    for (size_t k = 0; k < cell_of_tissue_.size(); ++k) {
      walls.diagonal[cell_of_tissue_[k]] = std::max(c.row(k).sum(), kLeastLumpedShare * c(k, k));
    }
    return walls;
  }
  if (static_cast<int>(cell_of_tissue_.size()) == cell_offset_.back()) {
    walls.full = &c;
    return walls;
  }
  full_compliance_ = walls.diagonal.asDiagonal();
  for (size_t b = 0; b < cell_of_tissue_.size(); ++b) {
    for (size_t a = 0; a < cell_of_tissue_.size(); ++a)
      full_compliance_(cell_of_tissue_[a], cell_of_tissue_[b]) = c(a, b);
  }
  walls.full = &full_compliance_;
  return walls;
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

/// Rest + C p of the cells that have walls of their own, rest of the others.
Eigen::VectorXd CoupledStep::gap_of_walls(const Eigen::VectorXd& pressure) const {
  Eigen::VectorXd gap = rest_volume_;
  for (size_t f = 0; f < films_.size(); ++f) {
    if (films_[f].wall != FilmWallKind::kWinkler) continue;
    const int n = films_[f].grid.n_cells();
    gap.segment(cell_offset_[f], n) +=
        pressure.segment(cell_offset_[f], n).cwiseProduct(rest_area_[f]) / films_[f].wall_stiffness;
  }
  return gap;
}

double CoupledStep::gap_error(const Eigen::VectorXd& gap, const Eigen::VectorXd& volume) const {
  const double total = std::max(volume.sum(), std::numeric_limits<double>::min());
  if (coupling_ == CouplingMode::kLumped) return std::abs((gap - volume).sum()) / total;
  return (gap - volume).cwiseAbs().sum() / total;
}

StepOutcome CoupledStep::try_step(const SimulationState& state, const std::vector<Eigen::VectorXd>& injected,
                                  double dt) {
  StepOutcome outcome;
  begin_film_step(state, injected, dt);
  coupling::FilmSolveResult solution;
  solution.pressure.resize(cell_offset_.back());
  solution.volume.resize(cell_offset_.back());
  for (size_t f = 0; f < films_.size(); ++f) {
    solution.pressure.segment(cell_offset_[f], films_[f].grid.n_cells()) = state.films[f].pressure;
    solution.volume.segment(cell_offset_[f], films_[f].grid.n_cells()) = state.films[f].volume;
    solution.flux.push_back(state.films[f].velocity);
  }
  outcome.state = state;
  if (!solve_tissue_and_films(state, dt, outcome, solution)) return outcome;
  finish(state, dt, solution, outcome);
  return outcome;
}

bool CoupledStep::solve_tissue_and_films(const SimulationState& from, double dt, StepOutcome& outcome,
                                         coupling::FilmSolveResult& solution) {
  std::vector<film::FilmProjection*> projections;
  for (const auto& projection : projections_) projections.push_back(projection.get());
  Eigen::Matrix3Xd& x = outcome.state.positions;
  for (outcome.newton_iterations = 1; outcome.newton_iterations <= kMaxNewtonIterations; ++outcome.newton_iterations) {
    Eigen::VectorXd gap_without_pressure = rest_volume_;
    Eigen::VectorXd force, response;
    if (tissue_) {
      if (!linearise_tissue(x, dt)) {
        outcome.reason = "the tissue's stiffness is not positive definite";
        return false;
      }
      force = compute_residual_force(from, x, dt);
      response = factor_->compute_gap_response(force);
      for (size_t k = 0; k < cell_of_tissue_.size(); ++k) {
        gap_without_pressure[cell_of_tissue_[k]] += gaps_->volume()[k] + response[k];
      }
    }
    solution = coupling::solve_films(projections, wall_compliance(), gap_without_pressure, solution);
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
    if (gap_error(outcome.gap, solution.volume) <= kGapTolerance) return true;
  }
  outcome.reason =
      absl::StrCat("the gap differs from the film's volume by a share of ", gap_error(outcome.gap, solution.volume),
                   " after ", kMaxNewtonIterations, " iterations");
  return false;
}

void CoupledStep::finish(const SimulationState& from, double dt, const coupling::FilmSolveResult& solution,
                         StepOutcome& outcome) {
  SimulationState& next = outcome.state;
  if (tissue_) {
    next.velocities = (next.positions - from.positions) / dt;
    outcome.min_scaled_jacobian = compute_min_scaled_jacobian(next);
    if (!(outcome.min_scaled_jacobian > 0.0)) {
      outcome.reason = "a hexahedron of the tissue is turned inside out";
      return;
    }
  }
  for (size_t f = 0; f < films_.size(); ++f) {
    const int n = films_[f].grid.n_cells();
    next.films[f].pressure = solution.pressure.segment(cell_offset_[f], n);
    next.films[f].volume = solution.volume.segment(cell_offset_[f], n);
    next.films[f].velocity = projections_[f]->compute_velocity(solution.flux[f]);
  }
  next.time = from.time + dt;
  next.step = from.step + 1;
  outcome.accepted = true;
}

double CoupledStep::compute_min_scaled_jacobian(const SimulationState& state) const {
  return tissue_ ? solid::compute_min_scaled_jacobian(tissue_->tissue.mesh(), state.positions) : 1.0;
}

Eigen::VectorXd CoupledStep::compute_gap(const SimulationState& state) {
  Eigen::VectorXd pressure(cell_offset_.back());
  for (size_t f = 0; f < films_.size(); ++f) {
    pressure.segment(cell_offset_[f], films_[f].grid.n_cells()) = state.films[f].pressure;
  }
  Eigen::VectorXd gap = gap_of_walls(pressure);
  if (!tissue_) return gap;
  gaps_->evaluate(state.positions);
  for (size_t k = 0; k < cell_of_tissue_.size(); ++k) gap[cell_of_tissue_[k]] += gaps_->volume()[k];
  return gap;
}

}  // namespace lipofill::simulation
