#include "core/film/rheology.h"

namespace lipofill::film {

double compute_friction_rate(const Fat& fat, double thickness) {
  if (!fat.wall_friction) return 0.0;
  return 12.0 * fat.viscosity / (fat.density * thickness * thickness);
}

double compute_conductance(const Fat& fat, double thickness, double dt) {
  if (thickness <= 0.0) return 0.0;
  if (!fat.wall_friction) return thickness * dt / fat.density;
  const double h2 = thickness * thickness;
  return h2 * thickness / (12.0 * fat.viscosity + fat.density * h2 / dt);
}

}  // namespace lipofill::film
