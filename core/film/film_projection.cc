#include "core/film/film_projection.h"

#include <algorithm>
#include <utility>

#include "core/film/edge_thickness.h"

namespace lipofill::film {
namespace {

/// Seals the edges of closed cells, as no fat crosses them.
void seal_closed_cells(const FilmGrid& grid, const std::vector<char>& is_closed, Eigen::VectorXd& edge_thickness) {
  if (is_closed.empty()) return;
  for (int e = 0; e < grid.n_edges(); ++e) {
    if (is_closed[grid.edges[e].left] || is_closed[grid.edges[e].right]) edge_thickness[e] = 0.0;
  }
}

}  // namespace

FilmProjection::FilmProjection(const FilmGrid& grid) : grid_(&grid), pressure_operator_(grid), law_(grid) {}

void FilmProjection::begin_step(FilmStepInput input) {
  input_ = std::move(input);
  begin_step();
}

void FilmProjection::begin_step() {
  law_.begin_step(*input_.metric, input_.fat, input_.dt);
}

void FilmProjection::set_thickness(const Values& volume_guess, const Values& flux_guess) {
  thickness_ = volume_guess.cwiseMax(0.0).cwiseQuotient(input_.metric->area);
  compute_edge_thickness(*grid_, thickness_, flux_guess, edge_thickness_);
  seal_closed_cells(*grid_, input_.is_closed, edge_thickness_);
  law_.set_thickness(edge_thickness_, input_.wall_stress);
  set_leaks(flux_guess);
  matrix_is_current_ = false;
}

void FilmProjection::set_leaks(const Values& flux_guess) {
  leak_conductance_.resize(static_cast<Eigen::Index>(grid_->leaky_walls.size()));
  for (Eigen::Index k = 0; k < leak_conductance_.size(); ++k) {
    const LeakyWall& wall = grid_->leaky_walls[k];
    const bool from_left = flux_guess.size() <= grid_->n_edges() || flux_guess[grid_->n_edges() + k] >= 0.0;
    const bool is_closed = !input_.is_closed.empty() && (input_.is_closed[wall.left] || input_.is_closed[wall.right]);
    const double upstream = is_closed ? 0.0 : thickness_[from_left ? wall.left : wall.right];
    const double filled = input_.leak_full_thickness > 0.0 ? std::min(1.0, upstream / input_.leak_full_thickness)
                                                           : static_cast<double>(upstream > 0.0);
    leak_conductance_[k] = wall.conductance * filled;
  }
}

void FilmProjection::compute_drive(const Values& pressure, Eigen::VectorXd& drive) const {
  compute_edge_difference(*grid_, pressure, drive);
  drive = input_.body_force - drive;
}

const Eigen::SparseMatrix<double>& FilmProjection::linearise(const Values& pressure) {
  if (matrix_is_current_ && is_linear()) return *matrix_;
  compute_drive(pressure, drive_);
  matrix_ = &pressure_operator_.assemble(law_.linearise(drive_), leak_conductance_, input_.dt);
  matrix_is_current_ = true;
  return *matrix_;
}

void FilmProjection::compute_flux(const Values& pressure, Eigen::VectorXd& flux) {
  const int n_edges = grid_->n_edges();
  flux.resize(n_edges + leak_conductance_.size());
  flux.head(n_edges) = edge_thickness_.cwiseProduct(input_.velocity);
  compute_drive(pressure, drive_);
  law_.add_flux(drive_, flux.head(n_edges));
  for (Eigen::Index k = 0; k < leak_conductance_.size(); ++k) {
    const LeakyWall& wall = grid_->leaky_walls[k];
    flux[n_edges + k] = leak_conductance_[k] * (pressure[wall.left] - pressure[wall.right]);
  }
}

Eigen::VectorXd FilmProjection::compute_flux(const Values& pressure) {
  Eigen::VectorXd flux;
  compute_flux(pressure, flux);
  return flux;
}

void FilmProjection::compute_volume(const Values& flux, Eigen::Ref<Eigen::VectorXd> volume) const {
  volume = input_.volume + input_.injected;
  const auto move = [this, v = volume.data()](int left, int right, double through) {
    v[left] -= input_.dt * through;
    v[right] += input_.dt * through;
  };
  const double* through = flux.data();
  for (const Edge& edge : grid_->edges) move(edge.left, edge.right, *through++);
  for (const LeakyWall& wall : grid_->leaky_walls) move(wall.left, wall.right, *through++);
}

Eigen::VectorXd FilmProjection::compute_volume(const Values& flux) const {
  Eigen::VectorXd volume(grid_->n_cells());
  compute_volume(flux, volume);
  return volume;
}

void FilmProjection::compute_velocity(const Values& flux, Eigen::VectorXd& velocity) const {
  const auto through_edges = flux.head(grid_->n_edges()).array();
  velocity = (edge_thickness_.array() > 0.0).select(through_edges / edge_thickness_.array().max(1e-300), 0.0);
}

void FilmProjection::compute_wall_stress(const Values& pressure, Eigen::VectorXd& stress) const {
  if (!input_.fat.is_elastic()) {
    stress.resize(0);
    return;
  }
  compute_drive(pressure, stress);
  stress = 0.5 * edge_thickness_.cwiseProduct(stress);
}

}  // namespace lipofill::film
