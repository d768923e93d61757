// The films' side of a coupled step: what each brings into it, its walls, and what becomes of it.

#include <algorithm>
#include <limits>
#include <utility>

#include "core/film/advection.h"
#include "core/film/edge_operators.h"
#include "core/film/edge_thickness.h"
#include "core/step/coupled_step.h"

namespace lipofill::step {
namespace {

/// C has negative entries on curved layers; a lumped cell keeps at least this share of its own compliance, so that J +
/// R stays definite.
constexpr double kLeastLumpedShare = 1e-3;
/// Fat thinner than this seeps through a leaky wall in proportion to its thickness, so that no cell is drained [m].
constexpr double kLeakFullThickness = 0.01e-3;

/// Fat enters the cells beside those whose pressure is above the entry pressure.
void enter_cells_beside_pressure(const plan::FilmLayout& layout, mechanics::FilmState& film) {
  if (film.is_entered.size() == 0) return;
  const Eigen::VectorXd before = film.is_entered;  // fat enters one cell a step
  const auto presses = [&](int cell) {
    return before[cell] > 0.0 && film.pressure[cell] > layout.connective_tissue.entry_pressure;
  };
  const auto enter = [&](int left, int right) {
    if (presses(left)) film.is_entered[right] = 1.0;
    if (presses(right)) film.is_entered[left] = 1.0;
  };
  for (const film::Edge& edge : layout.grid.edges) enter(edge.left, edge.right);
  for (const film::LeakyWall& wall : layout.grid.leaky_walls) enter(wall.left, wall.right);
}

}  // namespace

film::FilmMetric CoupledStep::film_metric(const mechanics::SimulationState& state, int film) const {
  if (gap_of_film_[film] < 0) return rest_metric_[film];
  return film::compute_film_metric(films_[film].grid, gaps_->film(gap_of_film_[film]).mid_surface(state.positions));
}

const Eigen::VectorXd& CoupledStep::measure_area(const mechanics::SimulationState& state, int film) {
  metric_.resize(films_.size());
  update_metric(state, static_cast<size_t>(film));
  return metric_[film].area;
}

/// metric_ of a film whose walls have moved.
void CoupledStep::update_metric(const mechanics::SimulationState& state, size_t f) {
  if (gap_of_film_[f] < 0) {
    if (metric_[f].area.size() == 0) metric_[f] = rest_metric_[f];
    return;
  }
  gaps_->film(gap_of_film_[f]).mid_surface(state.positions, metric_[f].vertices);
  film::update_film_metric(films_[f].grid, metric_[f]);
}

void CoupledStep::begin_film_step(const mechanics::SimulationState& state, const std::vector<Eigen::VectorXd>& injected,
                                  double dt) {
  metric_.resize(films_.size());
  for (size_t f = 0; f < films_.size(); ++f) {
    const mechanics::FilmState& film = state.films[f];
    const film::FilmGrid& grid = films_[f].grid;
    update_metric(state, f);
    film::FilmStepInput& input = projections_[f]->next_input();
    input.metric = &metric_[f];
    input.fat = fat_;
    input.fat.wall_friction = films_[f].wall_friction;
    input.volume = film.volume;
    input.injected = injected[f];
    if (input.fat.has_inertia()) {
      move_freely(f, film, input.fat, dt, input.velocity);
    } else {
      input.velocity.setZero(grid.n_edges());
    }
    work_.height.noalias() = metric_[f].centre.transpose() * gravity_;
    film::compute_edge_difference(grid, work_.height, input.body_force);
    input.body_force *= fat_.density;
    input.dt = dt;
    input.wall_stress = film.wall_stress;
    input.is_closed.assign(film.is_entered.size(), 0);
    for (Eigen::Index cell = 0; cell < film.is_entered.size(); ++cell)
      input.is_closed[cell] = film.is_entered[cell] == 0.0;
    input.leak_full_thickness = kLeakFullThickness;
    projections_[f]->begin_step();
  }
}

/// Viscosity and advection: the velocity that the pressure then corrects.
void CoupledStep::move_freely(size_t f, const mechanics::FilmState& film, const film::Fat& fat, double dt,
                              Eigen::VectorXd& velocity) {
  const film::FilmGrid& grid = films_[f].grid;
  work_.thickness = film.volume.cwiseMax(0.0).cwiseQuotient(metric_[f].area);
  film::compute_edge_thickness(grid, work_.thickness, film.velocity, work_.edge_thickness);
  viscosity_[f].advance(grid, metric_[f], fat, work_.thickness, work_.edge_thickness, film.velocity, dt, work_.viscous);
  advection_[f].advance(metric_[f], work_.viscous, dt, velocity);
}

/// On tissue a step is solved again from new positions, so that its films need be no more exact than that.
coupling::FilmTolerance CoupledStep::film_tolerance() const {
  if (cell_of_tissue_.empty()) return {};
  if (is_implicit()) return {1e-5, 1e-6};
  return {1e-7, 1e-8};
}

/// The compliance of every cell's walls, in the order of all cells.
void CoupledStep::set_walls(coupling::WallCompliance& walls) {
  walls.diagonal.setZero(cell_offset_.back());
  for (size_t f = 0; f < films_.size(); ++f) {
    if (films_[f].wall != plan::FilmWallKind::kWinkler) continue;
    walls.diagonal.segment(cell_offset_[f], films_[f].grid.n_cells()) = rest_area_[f] / films_[f].wall_stiffness;
  }
  if (cell_of_tissue_.empty()) return;
  const Eigen::VectorXd& lumped = factor_->lumped_compliance();
  const double mean = lumped.mean();
  for (size_t k = 0; k < cell_of_tissue_.size(); ++k) {
    const double own = is_implicit() ? mean : factor_->compliance()(k, k);
    walls.diagonal[cell_of_tissue_[k]] = std::max(lumped[k], kLeastLumpedShare * own);
  }
  if (coupling_ == plan::CouplingMode::kLumped) return;
  if (is_implicit()) {
    walls.tissue = factor_.get();
    walls.tissue_cells = &cell_of_tissue_;
    return;
  }
  const Eigen::MatrixXd& c = factor_->compliance();
  walls.dense = &c;
  if (static_cast<int>(cell_of_tissue_.size()) == cell_offset_.back()) return;
  full_compliance_ = walls.diagonal.asDiagonal();
  for (size_t b = 0; b < cell_of_tissue_.size(); ++b) {
    for (size_t a = 0; a < cell_of_tissue_.size(); ++a)
      full_compliance_(cell_of_tissue_[a], cell_of_tissue_[b]) = c(a, b);
  }
  walls.dense = &full_compliance_;
}

/// Rest + C p of the cells that have walls of their own, rest of the others.
void CoupledStep::set_gap_of_walls(const Eigen::VectorXd& pressure, Eigen::VectorXd& gap) const {
  gap = rest_volume_;
  for (size_t f = 0; f < films_.size(); ++f) {
    if (films_[f].wall != plan::FilmWallKind::kWinkler) continue;
    const int n = films_[f].grid.n_cells();
    gap.segment(cell_offset_[f], n) +=
        pressure.segment(cell_offset_[f], n).cwiseProduct(rest_area_[f]) / films_[f].wall_stiffness;
  }
}

/// Empty when no film has a limit. Cells that fat has not entered are held together by tissue, and rigid walls keep
/// whatever pressure there is.
void CoupledStep::set_lowest_pressure(const mechanics::SimulationState& state, Eigen::VectorXd& lowest) const {
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  if (-suction_limit_ == kNone) return;
  lowest.setConstant(cell_offset_.back(), -suction_limit_);
  for (size_t f = 0; f < films_.size(); ++f) {
    auto of_film = lowest.segment(cell_offset_[f], films_[f].grid.n_cells());
    if (films_[f].wall == plan::FilmWallKind::kRigid) of_film.setConstant(kNone);
    const Eigen::VectorXd& entered = state.films[f].is_entered;
    for (Eigen::Index cell = 0; cell < entered.size(); ++cell) {
      if (entered[cell] == 0.0) of_film[cell] = kNone;
    }
  }
}

/// The cannula parts the tissue where it delivers.
void CoupledStep::enter_injected_cells(const std::vector<Eigen::VectorXd>& injected,
                                       mechanics::SimulationState& state) const {
  for (size_t f = 0; f < films_.size(); ++f) {
    Eigen::VectorXd& entered = state.films[f].is_entered;
    for (Eigen::Index cell = 0; cell < entered.size(); ++cell) {
      if (injected[f][cell] > 0.0) entered[cell] = 1.0;
    }
  }
}

void CoupledStep::finish_films(const mechanics::SimulationState& from, double dt,
                               const coupling::FilmSolution& solution, mechanics::SimulationState& next) const {
  for (size_t f = 0; f < films_.size(); ++f) {
    const film::FilmGrid& grid = films_[f].grid;
    film::FilmProjection& projection = *projections_[f];
    mechanics::FilmState& film = next.films[f];
    film.pressure = solution.pressure.segment(cell_offset_[f], grid.n_cells());
    film.volume = solution.volume.segment(cell_offset_[f], grid.n_cells());
    projection.compute_velocity(solution.flux[f], film.velocity);
    projection.compute_wall_stress(film.pressure, film.wall_stress);
    film.earlier_volume_rate = from.films[f].volume_rate;
    film.earlier_pressure_rate = from.films[f].pressure_rate;
    film.volume_rate = (film.volume - from.films[f].volume) / dt;
    film.pressure_rate = (film.pressure - from.films[f].pressure) / dt;
    const double injection_work = film.pressure.dot(projection.input().injected);
    next.injection_work += injection_work;
    next.film_dissipation += injection_work - film.pressure.dot(film.volume - from.films[f].volume);
    enter_cells_beside_pressure(films_[f], film);
  }
}

}  // namespace lipofill::step
