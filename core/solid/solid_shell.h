#pragma once

#include <array>

#include "core/base/lanes.h"
#include "core/solid/hex_shape.h"

namespace lipofill::solid {

using ElasticityMatrix = Eigen::Matrix<double, 6, 6>;

/// Stiffness (24, 24) of the solid-shell hexahedron, for layers one element thick:
///
///   - the transverse shear strains 31 and 23 are taken at the mid-points of the edges of the
///     mid-surface and interpolated linearly across, and the thickness strain 33 at the corners of
///     the mid-surface (assumed natural strains: no shear or curvature thickness locking;
///     Hauptmann & Schweizerhof 1998, Klinkel, Gruttmann & Wagner 1999);
///   - seven enhanced modes, 11: xi, 22: eta, 33: zeta, xi zeta, eta zeta, 12: xi, eta (EAS-7: no
///     membrane, thickness or volumetric locking).
///
/// Passes membrane and bending patch tests on meshes distorted in the plane. zeta is the thickness
/// direction. [N/m]
/// @param nodes       rest positions [m], positive Jacobian
/// @param elasticity  D of compute_elasticity_matrix [Pa]
/// Checked by tests/unit/solid/element_test.cc, tests/verification/solid/.
HexStiffness compute_solid_shell_stiffness(const HexNodes& nodes, const ElasticityMatrix& elasticity);

/// The same of kLanes hexahedra side by side, the same bits, at a quarter of the time for each.
void compute_solid_shell_stiffness(const std::array<HexNodes, kLanes>& nodes,
                                   const std::array<ElasticityMatrix, kLanes>& elasticity,
                                   std::array<HexStiffness, kLanes>& stiffness);

}  // namespace lipofill::solid
