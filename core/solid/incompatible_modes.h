#pragma once

#include "core/solid/hex_shape.h"

namespace lipofill::solid {

/// Stiffness (24, 24) of the hexahedron with nine incompatible modes (EAS-9, Simo & Rifai 1990):
/// each covariant strain takes a linear term along each of its own directions,
///
///     11: xi   22: eta   33: zeta   12: xi, eta   23: eta, zeta   31: zeta, xi.
///
/// No direction is special, so it suits layers of several elements; it passes the patch test on
/// meshes distorted in space, but loses accuracy in bending of distorted thin plates, where
/// solid_shell.h is the element. [N/m]
/// @param nodes       rest positions [m], positive Jacobian
/// @param elasticity  D of compute_elasticity_matrix [Pa]
/// Checked by tests/unit/solid/element_test.cc, tests/verification/solid/.
HexStiffness compute_incompatible_modes_stiffness(const HexNodes& nodes, const Eigen::Matrix<double, 6, 6>& elasticity);

}  // namespace lipofill::solid
