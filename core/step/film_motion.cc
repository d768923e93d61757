#include "core/step/film_motion.h"

#include "core/film/edge_thickness.h"

namespace lipofill::step {

void FilmMotion::advance(const film::FilmMetric& metric, const film::Fat& fat, const mechanics::FilmState& film,
                         double dt, Eigen::VectorXd& velocity) {
  thickness_ = film.volume.cwiseMax(0.0).cwiseQuotient(metric.area);
  film::compute_edge_thickness(grid_, thickness_, film.velocity, edge_thickness_);
  viscosity_.advance(grid_, metric, fat, thickness_, edge_thickness_, film.velocity, dt, viscous_);
  advection_.advance(metric, viscous_, dt, velocity);
}

}  // namespace lipofill::step
