#include "core/film/flow_law.h"

#include <algorithm>
#include <cmath>

namespace lipofill::film {
namespace {

/// Share of the Newtonian conductance that an unyielded quadrant keeps in the tangent. It steers Newton's iteration
/// only, never the flux.
constexpr double kLeastTangent = 1e-9;

double quadratic(const QuadrantForm& w, double d1, double d2) {
  return w.w11 * d1 * d1 + 2.0 * w.w12 * d1 * d2 + w.w22 * d2 * d2;
}

/// 0 where the edge is sealed.
double at(const Eigen::VectorXd& values, int edge) {
  return edge < 0 ? 0.0 : values[edge];
}

/// Mean of the two edges' thicknesses that is either of them where the other is dry or sealed.
double mean_thickness(const Eigen::VectorXd& h, const QuadrantEdges& edges) {
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

void FlowLaw::prepare(const FilmMetric& metric, const Fat& fat, const Eigen::VectorXd& edge_thickness,
                      const Eigen::VectorXd& wall_stress, double dt) {
  fat_ = fat;
  const auto conductance = [&](auto of_thickness) {
    Eigen::VectorXd k(edge_thickness.size());
    for (Eigen::Index e = 0; e < k.size(); ++e) k[e] = of_thickness(edge_thickness[e]);
    return compute_conductance_forms(*grid_, metric, k);
  };
  const auto cubed = [](double h) { return h * h * h / 12.0; };
  elastic_start_.setZero(edge_thickness.size());
  if (fat.is_elastic()) {
    elastic_start_ =
        (edge_thickness.array() > 0.0).select(2.0 * wall_stress.array() / edge_thickness.array().max(1e-300), 0.0);
  }
  quadrants_.clear();
  if (fat.has_inertia()) {
    linear_ = conductance([&](double h) { return compute_conductance(fat, h, dt); });
    return;
  }
  const double elastic_rate = fat.is_elastic() ? 1.0 / (fat.shear_modulus * dt) : 0.0;
  linear_ = conductance([&](double h) { return elastic_rate * cubed(h); });
  const QuadrantForms reference = conductance([&](double h) { return cubed(h) / fat.viscosity; });
  quadrants_.resize(grid_->n_cells());
  for (int cell = 0; cell < grid_->n_cells(); ++cell) {
    for (int q = 0; q < 4; ++q) {
      const double h = mean_thickness(edge_thickness, quadrant_edges(*grid_, cell, q));
      if (h <= 0.0) continue;
      const double c = metric.quadrants[cell][q].sqrt_g / (48.0 * fat.viscosity);
      quadrants_[cell][q] = {reference[cell][q], 1.0 / (c * h * h * h), h};
    }
  }
}

FlowLaw::Response FlowLaw::respond(const Quadrant& quadrant, const QuadrantEdges& edges,
                                   const Eigen::VectorXd& drive) const {
  const QuadrantForm& w = quadrant.form;
  const double d1 = at(drive, edges.xi);
  const double d2 = at(drive, edges.eta);
  const double gradient = std::sqrt(quadrant.gradient_scale * std::max(0.0, quadratic(w, d1, d2)));
  const FlowFactor factor = compute_flow_factor(fat_, quadrant.thickness, gradient);
  return {factor.value, w.w11 * d1 + w.w12 * d2, w.w12 * d1 + w.w22 * d2,
          gradient > 0.0 ? factor.slope * quadrant.gradient_scale / gradient : 0.0};
}

Eigen::VectorXd FlowLaw::compute_flux(const Eigen::VectorXd& drive) const {
  Eigen::VectorXd flux = apply_forms(*grid_, linear_, drive - elastic_start_);
  for (size_t cell = 0; cell < quadrants_.size(); ++cell) {
    for (int q = 0; q < 4; ++q) {
      const QuadrantEdges edges = quadrant_edges(*grid_, static_cast<int>(cell), q);
      const Response response = respond(quadrants_[cell][q], edges, drive);
      if (edges.xi >= 0) flux[edges.xi] += response.factor * response.flux1;
      if (edges.eta >= 0) flux[edges.eta] += response.factor * response.flux2;
    }
  }
  return flux;
}

QuadrantForms FlowLaw::linearise(const Eigen::VectorXd& drive) const {
  QuadrantForms tangent = linear_;
  for (size_t cell = 0; cell < quadrants_.size(); ++cell) {
    for (int q = 0; q < 4; ++q) {
      const Quadrant& quadrant = quadrants_[cell][q];
      const Response response = respond(quadrant, quadrant_edges(*grid_, static_cast<int>(cell), q), drive);
      const double factor = std::max(response.factor, kLeastTangent);
      QuadrantForm& t = tangent[cell][q];
      t.w11 += factor * quadrant.form.w11 + response.curve * response.flux1 * response.flux1;
      t.w12 += factor * quadrant.form.w12 + response.curve * response.flux1 * response.flux2;
      t.w22 += factor * quadrant.form.w22 + response.curve * response.flux2 * response.flux2;
    }
  }
  return tangent;
}

}  // namespace lipofill::film
