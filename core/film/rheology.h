#pragma once

#include <limits>

namespace lipofill::film {

/// The friction of a film's walls; none is the paper's own model, for Newtonian fat only.
enum class WallFriction { kNoSlip, kNone };

/// Injected fat between two walls: a Herschel-Bulkley fluid, tau = tau_y + K rate^n (Newtonian by
/// default), in series with an elastic modulus (Maxwell) when that is finite.
struct Fat {
  double viscosity = 15.0;  ///< mu [Pa s], or the consistency K [Pa s^n]
  double density = 920.0;   ///< rho [kg/m3]
  WallFriction wall_friction = WallFriction::kNoSlip;
  double flow_index = 1.0;                                         ///< n, in (0, 1]
  double yield_stress = 0.0;                                       ///< tau_y [Pa]
  double shear_modulus = std::numeric_limits<double>::infinity();  ///< G of the Maxwell element [Pa]

  bool is_newtonian() const { return flow_index == 1.0 && yield_stress == 0.0; }
  bool is_elastic() const { return shear_modulus < std::numeric_limits<double>::infinity(); }
  /// Only Newtonian fat has inertia. rho h^2 / (12 mu dt), its share of the momentum, is below 1e-3
  /// for any fat thick enough to have a yield stress.
  bool has_inertia() const { return is_newtonian() && !is_elastic(); }
};

/// Rate of momentum loss to the walls, 12 mu / (rho h^2)  [1/s]; 0 without wall friction.
double compute_friction_rate(const Fat& fat, double thickness);

/// Flux through a unit square of the film per unit pressure drop over one implicit step,
///
///     k = h (dt/rho) / (1 + 12 mu dt / (rho h^2)) = h^3 / (12 mu + rho h^2 / dt)      [m3 / (Pa s)]
///
/// which is Reynolds lubrication, h^3 / (12 mu), once friction outweighs inertia. 0 for a dry edge.
/// Newtonian fat.
/// Checked by tests/unit/film/motion_test.cc and tests/verification/film/slot_test.cc.
double compute_conductance(const Fat& fat, double thickness, double dt);

/// Ratio of the flux between parallel plates to that of a Newtonian fluid of viscosity K at the
/// same pressure gradient G, and its derivative by G.
struct FlowFactor {
  double value = 0.0;  ///< f(G) = q(G) / (h^3 G / (12 K))
  double slope = 0.0;  ///< df/dG [m/Pa]
};

/// Plane Poiseuille flow of a Herschel-Bulkley fluid in closed form, tau_w = h G/2,
/// phi = tau_y/tau_w:
///
///     q = h^2/2 (tau_w/K)^(1/n) n/(2n+1) (1 - phi)^(1/n+1) (1 + n phi/(n+1)),    q = 0 where phi >= 1
///
/// For Bingham fat f = 1 - 3/2 phi + 1/2 phi^3. Nothing is regularised: below the yield stress
/// nothing flows. q is monotone and continuously differentiable in G. Source: Bird, Armstrong &
/// Hassager, Dynamics of Polymeric Liquids 1 (1987), 4.2. Checked by
/// tests/unit/film/rheology_test.cc and tests/verification/film/rheology_test.cc.
FlowFactor compute_flow_factor(const Fat& fat, double thickness, double pressure_gradient);

}  // namespace lipofill::film
