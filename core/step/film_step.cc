#include "core/step/film_step.h"

#include <algorithm>
#include <utility>

#include "core/film/edge_operators.h"
#include "core/step/tissue_entry.h"

namespace lipofill::step {
namespace {

/// Fat thinner than this seeps through a leaky wall in proportion to its thickness, so that no cell
/// is drained [m].
constexpr double kLeakFullThickness = 0.01e-3;
/// Iterations of conjugate gradients that a solve with an up-to-date preconditioner would need too.
constexpr int kPromptPressureIterations = 2;

}  // namespace

film::Fat make_fat(const plan::SimulationSpec& spec) {
  film::Fat fat;
  fat.viscosity = spec.fat_viscosity;
  fat.density = spec.fat_density;
  fat.flow_index = spec.fat_flow_index;
  fat.yield_stress = spec.fat_yield_stress;
  if (spec.fat_shear_modulus.has_value()) fat.shear_modulus = *spec.fat_shear_modulus;
  return fat;
}

FilmStep::FilmStep(const std::vector<plan::FilmLayout>& films, const mechanics::FilmCells& cells,
                   mechanics::FilmGeometry& geometry, const plan::SimulationSpec& spec, coupling::CoupledFactor* factor,
                   mechanics::StepCost& cost)
    : films_(films),
      cells_(cells),
      geometry_(geometry),
      cost_(cost),
      gravity_(spec.gravity),
      fat_(make_fat(spec)),
      suction_limit_(spec.suction_limit.value_or(std::numeric_limits<double>::infinity())),
      walls_(films, cells, geometry, spec.coupling, factor) {
  std::vector<film::FilmProjection*> projections;
  for (const plan::FilmLayout& film : films) {
    motion_.emplace_back(film.grid);
    projections_.push_back(std::make_unique<film::FilmProjection>(film.grid));
    projections.push_back(projections_.back().get());
  }
  solver_ = std::make_unique<coupling::FilmSolver>(std::move(projections));
  const bool is_dense = spec.coupling == plan::CouplingMode::kExact && factor != nullptr && factor->has_compliance();
  mobility_ =
      std::make_unique<LaggedMobility>(*solver_, is_dense && cells.n() > coupling::PressureSolver::kMaxDirectCells);
}

void FilmStep::set_rest(mechanics::SimulationState& state) const {
  for (size_t f = 0; f < films_.size(); ++f) {
    const film::FilmGrid& grid = films_[f].grid;
    mechanics::FilmState film;
    film.volume = walls_.rest_volume().segment(cells_.offset[f], grid.n_cells());
    film.pressure.setZero(grid.n_cells());
    film.velocity.setZero(grid.n_edges());
    film.volume_rate.setZero(grid.n_cells());
    film.pressure_rate.setZero(grid.n_cells());
    film.earlier_volume_rate.setZero(grid.n_cells());
    film.earlier_pressure_rate.setZero(grid.n_cells());
    if (mobility_->is_used()) film.factored_mobility.setZero(projections_[f]->pattern().nonZeros());
    if (fat_.is_elastic()) film.wall_stress.setZero(grid.n_edges());
    if (films_[f].connective_tissue.entry_pressure > 0.0) film.is_entered.setZero(grid.n_cells());
    state.films.push_back(std::move(film));
  }
}

void FilmStep::update_walls() {
  walls_.update();
  solver_->pressure_solver().set_walls(walls_.compliance());
}

void FilmStep::begin(const std::vector<Eigen::VectorXd>& injected, double dt, mechanics::SimulationState& state) {
  const mechanics::PhaseTimer timer(cost_.times.film);
  for (size_t f = 0; f < films_.size(); ++f) {
    Eigen::VectorXd& entered = state.films[f].is_entered;
    for (Eigen::Index cell = 0; cell < entered.size(); ++cell) {
      if (injected[f][cell] > 0.0) entered[cell] = 1.0;
    }
    begin_film(f, injected[f], dt, state);
  }
  find_lowest_pressure(state, lowest_);
}

void FilmStep::begin_film(size_t f, const Eigen::VectorXd& injected, double dt,
                          const mechanics::SimulationState& state) {
  const mechanics::FilmState& film = state.films[f];
  const film::FilmGrid& grid = films_[f].grid;
  const film::FilmMetric& metric = geometry_.update(f, state.positions);
  film::FilmStepInput& input = projections_[f]->next_input();
  input.metric = &metric;
  input.fat = fat_;
  input.fat.wall_friction = films_[f].wall_friction;
  input.volume = film.volume;
  input.injected = injected;
  if (input.fat.has_inertia()) {
    motion_[f].advance(metric, input.fat, film, dt, input.velocity);
  } else {
    input.velocity.setZero(grid.n_edges());
  }
  height_.noalias() = metric.centre.transpose() * gravity_;
  film::compute_edge_difference(grid, height_, input.body_force);
  input.body_force *= fat_.density;
  input.dt = dt;
  input.wall_stress = film.wall_stress;
  input.is_closed.assign(film.is_entered.size(), 0);
  for (Eigen::Index cell = 0; cell < film.is_entered.size(); ++cell)
    input.is_closed[cell] = film.is_entered[cell] == 0.0;
  input.leak_full_thickness = kLeakFullThickness;
  projections_[f]->begin_step();
}

void FilmStep::set_start_flux(const mechanics::SimulationState& from, coupling::FilmSolution& start) const {
  start.flux.resize(from.films.size());
  for (size_t f = 0; f < from.films.size(); ++f) {
    const Eigen::VectorXd& velocity = from.films[f].velocity;
    start.flux[f].setZero(velocity.size() + static_cast<Eigen::Index>(films_[f].grid.leaky_walls.size()));
    start.flux[f].head(velocity.size()) = velocity;
  }
}

bool FilmStep::solve(const Eigen::VectorXd& gap_without_pressure, mechanics::SimulationState& state,
                     coupling::FilmSolution& solution) {
  const mechanics::PhaseTimer timer(cost_.times.film);
  const coupling::PressureSolver& pressures = solver_->pressure_solver();
  const long solves = pressures.iterative_solves();
  const long iterations = pressures.iterations();
  const long fallbacks = pressures.fallbacks();
  solver_->solve(gap_without_pressure, lowest_, tolerance(), solution);
  const auto spent = static_cast<int>(pressures.iterations() - iterations);
  const auto prompt = kPromptPressureIterations * static_cast<int>(pressures.iterative_solves() - solves);
  cost_.iterative_iterations += spent;
  state.late_pressure_iterations += std::max(0, spent - prompt);
  cost_.fallbacks += static_cast<int>(pressures.fallbacks() - fallbacks);
  cost_.film_iterations += solution.iterations;
  return solution.converged;
}

/// On tissue a step is solved again from new positions, so that its films need be no more exact
/// than that.
coupling::FilmTolerance FilmStep::tolerance() const {
  if (cells_.on_tissue.empty()) return {};
  if (walls_.is_implicit()) return {1e-5, 1e-6};
  return {1e-7, 1e-8};
}

/// Finds the limit of each cell; there is none where no plan gives one. Cells that fat has not
/// entered are held together by tissue, and rigid walls keep whatever pressure there is.
void FilmStep::find_lowest_pressure(const mechanics::SimulationState& state, Eigen::VectorXd& lowest) const {
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  if (-suction_limit_ == kNone) return;
  lowest.setConstant(cells_.n(), -suction_limit_);
  for (size_t f = 0; f < films_.size(); ++f) {
    auto of_film = lowest.segment(cells_.offset[f], cells_.n_of(f));
    if (films_[f].wall == plan::FilmWallKind::kRigid) of_film.setConstant(kNone);
    const Eigen::VectorXd& entered = state.films[f].is_entered;
    for (Eigen::Index cell = 0; cell < entered.size(); ++cell) {
      if (entered[cell] == 0.0) of_film[cell] = kNone;
    }
  }
}

void FilmStep::finish(const mechanics::SimulationState& from, double dt, const coupling::FilmSolution& solution,
                      mechanics::SimulationState& next) const {
  const mechanics::PhaseTimer timer(cost_.times.film);
  for (size_t f = 0; f < films_.size(); ++f) {
    film::FilmProjection& projection = *projections_[f];
    mechanics::FilmState& film = next.films[f];
    film.pressure = solution.pressure.segment(cells_.offset[f], cells_.n_of(f));
    film.volume = solution.volume.segment(cells_.offset[f], cells_.n_of(f));
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

Eigen::VectorXd FilmStep::compute_void(const mechanics::SimulationState& state, const Eigen::VectorXd& gap) const {
  Eigen::VectorXd pressure, volume, lowest;
  cells_.gather(state, &mechanics::FilmState::pressure, pressure);
  cells_.gather(state, &mechanics::FilmState::volume, volume);
  find_lowest_pressure(state, lowest);
  if (lowest.size() == 0) return Eigen::VectorXd::Zero(gap.size());
  const Eigen::VectorXd excess = (gap - volume).cwiseMax(0.0);
  return (pressure.array() <= lowest.array()).select(excess, 0.0);
}

}  // namespace lipofill::step
