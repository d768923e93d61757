#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/solid/hex_mesh.h"
#include "core/solid/material.h"
#include "core/solid/system_pattern.h"

namespace lipofill::solid {

/// Tension in the plane of a layer at rest, like that of living skin: the second Piola-Kirchhoff
/// stress
///
///     S0 = sigma_0 (I - n n^T)        n: normal of the element's mid-surface at its centre, at rest  [Pa]
///
/// The rest shape is in equilibrium: whatever holds it (the neighbouring skin, the underside)
/// carries the out-of-balance force of S0, and keeps carrying it. What a displacement u = x - X
/// adds is then linear,
///
///     f = K_pre u,   K_pre(a, b) = sum_e V_e (grad N_a . S0 grad N_b) I,   energy = 1/2 u^T K_pre u
///
/// with gradients at element centres, exact for the second-order part S0 : 1/2 (grad u)^T grad u of
/// the energy of a constant S0. It resists bending out of the plane as a membrane under T = sigma_0
/// t does. No double counting: elasticity and K_G (geometric_stiffness.h) see the strain from the
/// rest shape alone, never S0.
///
/// Covariant: n turns with the rest shape, so turning the whole patient turns f. But f is not
/// invariant when the deformed tissue turns against its own rest shape: the load that balances S0
/// at rest does not follow. Neglected too: relaxation of S0 with the strain (living skin loses
/// tension when it shortens), anisotropy along Langer's lines.
/// Checked by tests/unit/solid/prestress_test.cc and tests/verification/solid/prestress_test.cc.
class Prestress {
 public:
  Prestress(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials, const SystemPattern& pattern);

  /// K_pre: the number of I in each block of the pattern [N/m]; empty without tension.
  const Eigen::VectorXd& stiffness() const { return stiffness_; }
  /// Adds K_pre (x - X) to `force`; returns the energy [J]. Both have four numbers a node, the last
  /// of no meaning. Allocates nothing.
  double add_force(const Eigen::Matrix4Xd& x, Eigen::Matrix4Xd& force) const;

 private:
  struct Element {
    std::array<int, 8> nodes;
    Eigen::Matrix<double, 3, 8> rest;      ///< [m]
    Eigen::Matrix<double, 3, 8> gradient;  ///< of the shape functions at the centre, at rest [1/m]
    Eigen::Matrix3d stress;                ///< V_e S0 [N m]
  };

  std::vector<Element> elements_;  ///< those under tension
  Eigen::VectorXd stiffness_;
};

}  // namespace lipofill::solid
