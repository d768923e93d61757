#include "core/film/flow_law.h"

#include <algorithm>
#include <cmath>

namespace lipofill::film {
namespace {

/// Share of the Newtonian conductance that an unyielded quadrant has in the tangent. It steers
/// Newton's iteration only, never the flux.
constexpr double kLeastTangent = 1e-9;

double quadratic(const QuadrantForm& w, double d1, double d2) {
  return w.w11 * d1 * d1 + 2.0 * w.w12 * d1 * d2 + w.w22 * d2 * d2;
}

/// 0 where the edge is sealed.
double at(const double* values, int edge) {
  return edge < 0 ? 0.0 : values[edge];
}

/// Mean of the two edges' thicknesses that is either of them where the other is dry or sealed.
double mean_thickness(const double* h, const QuadrantEdges& edges) {
  const double h1 = at(h, edges.xi);
  const double h2 = at(h, edges.eta);
  return h1 + h2 > 0.0 ? (h1 * h1 + h2 * h2) / (h1 + h2) : 0.0;
}

}  // namespace

struct FlowLaw::Response {
  double factor = 0.0;  ///< f
  double flux1 = 0.0;   ///< w D, the reference flux through the xi-edge and the eta-edge
  double flux2 = 0.0;
  double curve = 0.0;  ///< f' / (|grad| c h^3), what the rank-one part of the tangent is multiplied by
};

void FlowLaw::begin_step(const FilmMetric& metric, const Fat& fat, double dt) {
  metric_ = &metric;
  fat_ = fat;
  dt_ = dt;
  compute_unit_forms(*grid_, metric, unit_);
}

void FlowLaw::set_thickness(const Eigen::VectorXd& edge_thickness, const Eigen::VectorXd& wall_stress) {
  elastic_start_.setZero(edge_thickness.size());
  if (fat_.has_inertia()) {
    quadrants_.clear();
    scale_by(
        edge_thickness, [this](double h) { return compute_conductance(fat_, h, dt_); }, linear_);
    return;
  }
  scale_by(
      edge_thickness, [this](double h) { return h * h * h / (12.0 * fat_.viscosity); }, reference_);
  set_quadrants(edge_thickness);
  set_elastic_part(edge_thickness, wall_stress);
}

template <typename OfThickness>
void FlowLaw::scale_by(const Eigen::VectorXd& edge_thickness, OfThickness conductance, QuadrantForms& forms) {
  conductance_.resize(edge_thickness.size());
  std::transform(edge_thickness.begin(), edge_thickness.end(), conductance_.begin(), conductance);
  scale_forms(*grid_, unit_, conductance_, root_, forms);
}

void FlowLaw::set_quadrants(const Eigen::VectorXd& edge_thickness) {
  quadrants_.resize(grid_->n_cells());
  for (int cell = 0; cell < grid_->n_cells(); ++cell) {
    for (int q = 0; q < 4; ++q) {
      const double h = mean_thickness(edge_thickness.data(), quadrant_edges(*grid_, cell, q));
      const QuadrantMetric& metric = metric_->quadrants[cell][q];
      const double c = metric.share * metric.sqrt_g / (48.0 * fat_.viscosity);
      quadrants_[cell][q] = h > 0.0 && c > 0.0 ? Quadrant{reference_[cell][q], 1.0 / (c * h * h * h), h} : Quadrant{};
    }
  }
}

void FlowLaw::set_elastic_part(const Eigen::VectorXd& edge_thickness, const Eigen::VectorXd& wall_stress) {
  if (!fat_.is_elastic()) {
    linear_.assign(unit_.size(), {});
    return;
  }
  const double rate = 1.0 / (fat_.shear_modulus * dt_);
  scale_by(
      edge_thickness, [rate](double h) { return rate * h * h * h / 12.0; }, linear_);
  elastic_start_ =
      (edge_thickness.array() > 0.0).select(2.0 * wall_stress.array() / edge_thickness.array().max(1e-300), 0.0);
}

FlowLaw::Response FlowLaw::respond(const Quadrant& quadrant, const QuadrantEdges& edges, const double* drive) const {
  const QuadrantForm& w = quadrant.form;
  const double d1 = at(drive, edges.xi);
  const double d2 = at(drive, edges.eta);
  const double gradient = std::sqrt(quadrant.gradient_scale * std::max(0.0, quadratic(w, d1, d2)));
  const FlowFactor factor = compute_flow_factor(fat_, quadrant.thickness, gradient);
  return {factor.value, w.w11 * d1 + w.w12 * d2, w.w12 * d1 + w.w22 * d2,
          gradient > 0.0 ? factor.slope * quadrant.gradient_scale / gradient : 0.0};
}

void FlowLaw::add_flux(const Eigen::VectorXd& drive, Eigen::Ref<Eigen::VectorXd> flux) {
  beyond_start_ = drive - elastic_start_;
  add_flux_of_forms(*grid_, linear_, beyond_start_, flux);
  for (size_t cell = 0; cell < quadrants_.size(); ++cell) {
    for (int q = 0; q < 4; ++q) {
      const QuadrantEdges edges = quadrant_edges(*grid_, static_cast<int>(cell), q);
      const Response response = respond(quadrants_[cell][q], edges, drive.data());
      if (edges.xi >= 0) flux.data()[edges.xi] += response.factor * response.flux1;
      if (edges.eta >= 0) flux.data()[edges.eta] += response.factor * response.flux2;
    }
  }
}

const QuadrantForms& FlowLaw::linearise(const Eigen::VectorXd& drive) {
  if (quadrants_.empty()) return linear_;
  tangent_ = linear_;
  for (size_t cell = 0; cell < quadrants_.size(); ++cell) {
    for (int q = 0; q < 4; ++q) {
      const Quadrant& quadrant = quadrants_[cell][q];
      const Response response = respond(quadrant, quadrant_edges(*grid_, static_cast<int>(cell), q), drive.data());
      const double factor = std::max(response.factor, kLeastTangent);
      QuadrantForm& t = tangent_[cell][q];
      t.w11 += factor * quadrant.form.w11 + response.curve * response.flux1 * response.flux1;
      t.w12 += factor * quadrant.form.w12 + response.curve * response.flux1 * response.flux2;
      t.w22 += factor * quadrant.form.w22 + response.curve * response.flux2 * response.flux2;
    }
  }
  return tangent_;
}

}  // namespace lipofill::film
