#pragma once

namespace lipofill::film {

/// Injected fat as a Newtonian fluid between two walls.
struct Fat {
  double viscosity = 15.0;    ///< mu  [Pa s]
  double density = 920.0;     ///< rho [kg/m3]
  bool wall_friction = true;  ///< 12 mu / h^2 between no-slip walls; false: the paper's own model
};

/// Rate of momentum loss to the walls, 12 mu / (rho h^2)  [1/s]; 0 without wall friction.
double compute_friction_rate(const Fat& fat, double thickness);

/// Flux through a unit square of the film per unit pressure drop over one implicit step,
///
///     k = h (dt/rho) / (1 + 12 mu dt / (rho h^2)) = h^3 / (12 mu + rho h^2 / dt)      [m3 / (Pa s)]
///
/// which is Reynolds lubrication, h^3 / (12 mu), once friction outweighs inertia. 0 for a dry edge.
/// Checked by tests/unit/film/motion_test.cc and tests/verification/film/slot_test.cc.
double compute_conductance(const Fat& fat, double thickness, double dt);

}  // namespace lipofill::film
