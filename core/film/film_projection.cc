#include "core/film/film_projection.h"

#include <utility>

#include "core/film/edge_thickness.h"

namespace lipofill::film {

FilmProjection::FilmProjection(const FilmGrid& grid) : grid_(&grid), pressure_operator_(grid) {}

void FilmProjection::begin_step(FilmStepInput input) {
  input_ = std::move(input);
}

void FilmProjection::linearise(const Eigen::VectorXd& volume_guess, const Eigen::VectorXd& flux_guess) {
  const Eigen::VectorXd h = volume_guess.cwiseMax(0.0).cwiseQuotient(input_.metric->area);
  edge_thickness_ = compute_edge_thickness(*grid_, h, flux_guess);
  conductance_.resize(edge_thickness_.size());
  for (int e = 0; e < grid_->n_edges(); ++e) {
    conductance_[e] = input_.dt * compute_conductance(input_.fat, edge_thickness_[e], input_.dt);
  }
  pressure_matrix_ = &pressure_operator_.assemble(*grid_, *input_.metric, conductance_);
  conductance_ /= input_.dt;
  explicit_flux_ = edge_thickness_.cwiseProduct(input_.velocity) +
                   apply_conductance(*grid_, *input_.metric, conductance_, input_.body_force);
  explicit_volume_ = compute_volume(explicit_flux_);
}

Eigen::VectorXd FilmProjection::compute_flux(const Eigen::VectorXd& pressure) const {
  return explicit_flux_ -
         apply_conductance(*grid_, *input_.metric, conductance_, compute_edge_difference(*grid_, pressure));
}

Eigen::VectorXd FilmProjection::compute_volume(const Eigen::VectorXd& flux) const {
  return input_.volume + input_.injected - input_.dt * compute_outflow(*grid_, flux);
}

Eigen::VectorXd FilmProjection::compute_velocity(const Eigen::VectorXd& flux) const {
  return (edge_thickness_.array() > 0.0).select(flux.array() / edge_thickness_.array().max(1e-300), 0.0);
}

}  // namespace lipofill::film
