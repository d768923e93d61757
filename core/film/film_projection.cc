#include "core/film/film_projection.h"

#include <algorithm>
#include <utility>

#include "core/film/edge_thickness.h"

namespace lipofill::film {
namespace {

/// No fat crosses the edge of a closed cell.
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
}

void FilmProjection::set_thickness(const Eigen::VectorXd& volume_guess, const Eigen::VectorXd& flux_guess) {
  const Eigen::VectorXd h = volume_guess.cwiseMax(0.0).cwiseQuotient(input_.metric->area);
  edge_thickness_ = compute_edge_thickness(*grid_, h, flux_guess.head(grid_->n_edges()));
  seal_closed_cells(*grid_, input_.is_closed, edge_thickness_);
  law_.prepare(*input_.metric, input_.fat, edge_thickness_, input_.wall_stress, input_.dt);
  leak_conductance_.resize(static_cast<Eigen::Index>(grid_->leaky_walls.size()));
  for (Eigen::Index k = 0; k < leak_conductance_.size(); ++k) {
    const LeakyWall& wall = grid_->leaky_walls[k];
    const bool from_left = flux_guess.size() <= grid_->n_edges() || flux_guess[grid_->n_edges() + k] >= 0.0;
    const bool is_closed = !input_.is_closed.empty() && (input_.is_closed[wall.left] || input_.is_closed[wall.right]);
    const double upstream = is_closed ? 0.0 : h[from_left ? wall.left : wall.right];
    const double filled = input_.leak_full_thickness > 0.0 ? std::min(1.0, upstream / input_.leak_full_thickness)
                                                           : static_cast<double>(upstream > 0.0);
    leak_conductance_[k] = wall.conductance * filled;
  }
  matrix_is_current_ = false;
}

Eigen::VectorXd FilmProjection::compute_drive(const Eigen::VectorXd& pressure) const {
  return input_.body_force - compute_edge_difference(*grid_, pressure);
}

const Eigen::SparseMatrix<double>& FilmProjection::linearise(const Eigen::VectorXd& pressure) {
  if (matrix_is_current_ && is_linear()) return *matrix_;
  QuadrantForms forms = law_.linearise(compute_drive(pressure));
  for (auto& quadrants : forms) {
    for (QuadrantForm& form : quadrants) form = {input_.dt * form.w11, input_.dt * form.w12, input_.dt * form.w22};
  }
  matrix_ = &pressure_operator_.assemble(*grid_, forms, input_.dt * leak_conductance_);
  matrix_is_current_ = true;
  return *matrix_;
}

Eigen::VectorXd FilmProjection::compute_flux(const Eigen::VectorXd& pressure) const {
  Eigen::VectorXd flux(grid_->n_edges() + leak_conductance_.size());
  flux.head(grid_->n_edges()) =
      edge_thickness_.cwiseProduct(input_.velocity) + law_.compute_flux(compute_drive(pressure));
  for (Eigen::Index k = 0; k < leak_conductance_.size(); ++k) {
    const LeakyWall& wall = grid_->leaky_walls[k];
    flux[grid_->n_edges() + k] = leak_conductance_[k] * (pressure[wall.left] - pressure[wall.right]);
  }
  return flux;
}

Eigen::VectorXd FilmProjection::compute_volume(const Eigen::VectorXd& flux) const {
  Eigen::VectorXd volume = input_.volume + input_.injected;
  volume -= input_.dt * compute_outflow(*grid_, flux.head(grid_->n_edges()));
  for (size_t k = 0; k < grid_->leaky_walls.size(); ++k) {
    const double moved = input_.dt * flux[grid_->n_edges() + static_cast<Eigen::Index>(k)];
    volume[grid_->leaky_walls[k].left] -= moved;
    volume[grid_->leaky_walls[k].right] += moved;
  }
  return volume;
}

Eigen::VectorXd FilmProjection::compute_velocity(const Eigen::VectorXd& flux) const {
  const auto through_edges = flux.head(grid_->n_edges()).array();
  return (edge_thickness_.array() > 0.0).select(through_edges / edge_thickness_.array().max(1e-300), 0.0);
}

Eigen::VectorXd FilmProjection::compute_wall_stress(const Eigen::VectorXd& pressure) const {
  if (!input_.fat.is_elastic()) return {};
  return 0.5 * edge_thickness_.cwiseProduct(compute_drive(pressure));
}

}  // namespace lipofill::film
