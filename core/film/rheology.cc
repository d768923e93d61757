#include "core/film/rheology.h"

#include <cmath>

namespace lipofill::film {

double compute_friction_rate(const Fat& fat, double thickness) {
  if (fat.wall_friction == WallFriction::kNone) return 0.0;
  return 12.0 * fat.viscosity / (fat.density * thickness * thickness);
}

double compute_conductance(const Fat& fat, double thickness, double dt) {
  if (thickness <= 0.0) return 0.0;
  if (fat.wall_friction == WallFriction::kNone) return thickness * dt / fat.density;
  const double h2 = thickness * thickness;
  return h2 * thickness / (12.0 * fat.viscosity + fat.density * h2 / dt);
}

FlowFactor compute_flow_factor(const Fat& fat, double thickness, double pressure_gradient) {
  if (fat.is_newtonian()) return {1.0, 0.0};
  const double wall_stress = 0.5 * thickness * pressure_gradient;
  if (wall_stress <= fat.yield_stress || wall_stress <= 0.0) return {};
  const double n = fat.flow_index;
  const double phi = fat.yield_stress / wall_stress;
  const double plug = 1.0 + n * phi / (n + 1.0);
  const double shape = n / (2.0 * n + 1.0) * std::pow(1.0 - phi, 1.0 / n + 1.0) * plug;
  FlowFactor factor;
  factor.value = 3.0 * std::pow(wall_stress / fat.viscosity, 1.0 / n - 1.0) * shape;
  const double shape_by_phi = -(1.0 / n + 1.0) / (1.0 - phi) + n / ((n + 1.0) * plug);
  const double logarithmic_slope = (1.0 / n - 1.0 - phi * shape_by_phi) / wall_stress;
  factor.slope = factor.value * logarithmic_slope * 0.5 * thickness;
  return factor;
}

}  // namespace lipofill::film
