#include "core/film/viscosity.h"

namespace lipofill::film {
namespace {

/// Makes the system regular on dry edges, whose velocity is set to zero afterwards [m].
constexpr double kThinnest = 1e-7;
constexpr double kTolerance = 1e-13;
/// Conjugate gradients end after as many iterations as there are unknowns but for rounding.
constexpr int kMaxIterationsAnEdge = 4;

}  // namespace

ImplicitViscosity::ImplicitViscosity(const FilmGrid& grid) : system_(grid) {}

Eigen::VectorXd ImplicitViscosity::advance(const FilmGrid& grid, const FilmMetric& metric, const Fat& fat,
                                           const Eigen::VectorXd& cell_thickness, const Eigen::VectorXd& edge_thickness,
                                           const Eigen::VectorXd& velocity, double dt) {
  Eigen::VectorXd next;
  advance(grid, metric, fat, cell_thickness, edge_thickness, velocity, dt, next);
  return next;
}

void ImplicitViscosity::advance(const FilmGrid& grid, const FilmMetric& metric, const Fat& fat,
                                const Eigen::VectorXd& cell_thickness, const Eigen::VectorXd& edge_thickness,
                                const Eigen::VectorXd& velocity, double dt, Eigen::VectorXd& next) {
  thickness_ = edge_thickness.cwiseMax(kThinnest);
  damped_thickness_.resize(thickness_.size());
  next.resize(thickness_.size());
  for (Eigen::Index e = 0; e < thickness_.size(); ++e) {
    const double damping = 1.0 + dt * compute_friction_rate(fat, thickness_[e]);
    damped_thickness_[e] = thickness_[e] * damping;
    next[e] = velocity[e] / damping;
  }
  system_.set_metric(grid, metric);
  scale_forms(grid, system_.unit_mass(), thickness_, root_, mass_);
  system_.set(grid, metric, damped_thickness_, cell_thickness, dt * fat.viscosity / fat.density);
  right_side_.setZero(grid.n_edges());
  add_flux_of_forms(grid, mass_, velocity, right_side_);
  solve(grid, next);
  next = (edge_thickness.array() > 0.0).select(next, 0.0);
}

/// Improves `u` by conjugate gradients, preconditioned by the diagonal.
void ImplicitViscosity::solve(const FilmGrid& grid, Eigen::VectorXd& u) {
  const Eigen::VectorXd& diagonal = system_.diagonal();
  system_.multiply(grid, u, product_);
  residual_ = right_side_ - product_;
  scaled_ = residual_.cwiseQuotient(diagonal);
  direction_ = scaled_;
  double error = residual_.dot(scaled_);
  const double target = kTolerance * kTolerance * right_side_.cwiseProduct(right_side_).cwiseQuotient(diagonal).sum();
  for (int k = 0; k < kMaxIterationsAnEdge * grid.n_edges() && error > target; ++k) {
    system_.multiply(grid, direction_, product_);
    const double length = error / direction_.dot(product_);
    u += length * direction_;
    residual_ -= length * product_;
    scaled_ = residual_.cwiseQuotient(diagonal);
    const double last = error;
    error = residual_.dot(scaled_);
    direction_ = scaled_ + (error / last) * direction_;
  }
}

}  // namespace lipofill::film
