#pragma once

#include <array>
#include <cstdint>

#include "core/base/lanes.h"
#include "core/solid/element_batch.h"
#include "core/solid/hex_shape.h"

namespace lipofill::solid {

/// The data of kLanes neo-Hookean hexahedra, all stacked or none.
///
/// With h_k the products of local coordinates, s_k = sum_b h_k(b) x_b and S_k the same at rest, an
/// element has
///
///     F = sum_k s_k (x) B_k,   B_k = 1/V dV/dS_k       mean gradient over the element (Flanagan & Belytschko 1981)
///     v(s)                                             its volume, exact for the trilinear hexahedron
///     w_k = s_k - F S_k,  k = 3, 5, 6, 7               what is not homogeneous: bending, twist, warping
///     g^i = F^-T G^i                                   dual base vectors at the centre
///
/// and the energy
///
///     W = V (mu/2 (J^-2/3 |F|^2 - 3) + kappa/2 (v/V - 1)^2) + W_h(w, g),   J = det F
///
/// the law of CalculiX' and Abaqus' *HYPERELASTIC, NEO HOOKE. The volume is that of the hexahedron
/// itself, so that tissue keeps what one sees of it. W_h is the solid-shell's in closed form:
/// assumed natural strains and the seven enhanced ones condensed on the deformed parallelepiped,
/// isotropic there with the moduli mu and lambda, which is the second-order term of the law about F
/// for nearly incompressible tissue (after Puso 2000 and Schwarze & Reese 2011). With e the
/// symmetric part and per unit of the rest volume
///
///     xi:    1/3 Psi(e(w_3 (x) g^2 + w_5 (x) g^3)), sigma g^1 = 0
///     eta:   1/3 Psi(e(w_3 (x) g^1 + w_6 (x) g^3)), sigma g^2 = 0
///     zeta:  1/3 Psi(e(w_5 (x) g^1 + w_6 (x) g^2)), g^3 . sigma g^3 = 0; stacked: sigma g^3 = 0
///     w_7:   1/9 (sum_i mu |e(w_7 (x) g^i)|^2 + lambda*/2 (w_7 . g^i)^2);  not stacked: of i = 3 only along g^3
///
///     Psi(e) = mu |e|^2 + lambda/2 tr(e)^2 in what the conditions leave free,  lambda* = 2 lambda mu/(lambda + 2 mu)
///
/// The shear strains along zeta keep their part that varies through the thickness (tied at the
/// edges of both faces, as in Schwarze & Reese): without it an element narrower than thick has a
/// soft mode of its thickness.
///
/// Homogeneous states have w = 0 exactly, so every patch test holds for every shape. Nothing locks
/// at nu = 0.5: each element has one volume, and what is not homogeneous is free of it. Energy and
/// forces are functions of x alone, the force is the exact slope of the energy, and turning x turns
/// the force. Below J = kLeastRatio the law goes on as a parabola in J: forces stay finite in
/// elements that are inside out.
/// Checked by tests/unit/solid/neo_hookean_test.cc and
/// tests/verification/solid/neo_hookean_*_test.cc.
struct NeoHookeanBatch {
  static constexpr double kLeastRatio = 0.05;  ///< of J

  Lanes gradient[6][3];                    ///< B_k of the modes 1 to 6 [1/m]
  Lanes dual[3][3];                        ///< G^i/8 at the centre, at rest [1/m]
  Lanes rest_hourglass[4][3];              ///< S_k [m]
  Lanes shear, bulk, relaxed;              ///< mu, kappa and lambda* times volume, at a modulus of 1 Pa [m3]
  Lanes inverse_volume;                    ///< 1/(64 V) [1/m3]
  Lanes squeezed_corner;                   ///< a corner's volume below this may be one for the inversion barrier [m3]
  int nodes[8][kLanes];                    ///< in binary order
  std::int32_t block[kNodePairs][kLanes];  ///< in NodeBlocks
  std::array<bool, kNodePairs> is_transposed;  ///< as in StiffnessBatch
  bool is_stacked;

  /// `rest` (3, 8): positions in the order of HexMesh.
  void set_lane(int lane, const std::array<int, 8>& hexahedron, const HexNodes& rest, double poisson_ratio);
  /// Takes energy, forces and stiffness from a lane that only fills the batch up.
  void silence_lane(int lane);
};

/// Intermediate values on the way to the forces, which the tangent goes on from.
struct NeoHookeanPose {
  Lanes shear, bulk, relaxed;  ///< mu, kappa and lambda* times volume [J]
  Lanes energy;                ///< W [J]
  Lanes volume_ratio;          ///< det F
  Lanes least_corner;          ///< least over the corners of det[e_1 e_2 e_3] [m3]
  LaneMatrix3 gradient;        ///< F
  LaneMatrix3 inverse;         ///< F^-T
  Lanes isochoric;             ///< J^-2/3
  Lanes volume_strain;         ///< v/V - 1
  Vector3<Lanes> volume[8];    ///< 64 dv/ds_k
  Vector3<Lanes> dual[3];      ///< g^i
};

/// Adds dW/dx to `force`; both hold four numbers a node, the last of no meaning.
/// @param modulus  Young's modulus of each lane [Pa]
void add_neo_hookean_forces(const NeoHookeanBatch& batch, const Lanes& modulus, const double* x, NeoHookeanPose& pose,
                            double* force);

/// Adds a symmetric positive definite tangent to blocks in the layout of NodeBlocks:
///
///     V (2 mu' dev e : dev e + grad u (tau - c I)+ grad u^T) + kappa V (dv/V)^2 + W_h with g held
///
/// with tau = mu dev(J^-2/3 F F^T) + kappa v/V (v/V - 1) I the Kirchhoff stress. c grad u : grad
/// u^T integrates to what happens on the boundary alone, so any c may be taken from tau and put on
/// mu' = mu J^-2/3 |F|^2/3 - kappa v/V (v/V - 1) + c. c is the value nearest to zero among the
/// principal stresses' range: mu' then lies between the least and the largest eigenvalue of mu
/// J^-2/3 F F^T. At rest it is the slope of the force, elsewhere off by a share of the strain.
void add_neo_hookean_stiffness(const NeoHookeanBatch& batch, const NeoHookeanPose& pose, double* blocks);

}  // namespace lipofill::solid
