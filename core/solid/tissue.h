#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "absl/status/statusor.h"
#include "core/solid/hex_mesh.h"
#include "core/solid/material.h"

namespace lipofill::solid {

/// How the nodes are held. Nodes may be in several entries; fixed wins over springs.
struct NodeSupports {
  std::vector<std::array<bool, 3>> fixed;  ///< a triple a node: x, y, z held at rest
  std::vector<double> spring;              ///< isotropic spring to the rest position, a value a node [N/m], 0: none
};

/// Rayleigh damping D = alpha M + beta K.
struct RayleighDamping {
  double alpha = 0.0;  ///< [1/s]
  double beta = 0.0;   ///< [s]
};

/// Corotational finite-element tissue:
///
///     f_int(x) = sum_e R_e K_e (R_e^T x_e - X_e)        R_e: rotation of the element's centre, K_e constant (24, 24)
///     S        = M/dt^2 + D/dt + K,   K = sum_e R_e K_e R_e^T + springs
///
/// after Mueller & Gross (2004); S is the paper's K of eq. 5. Mass is lumped. Degrees of freedom are the components of nodes that are
/// not fixed, numbered node by node.
///
/// Checked by tests/unit/solid/ and tests/verification/ (patch test, rigid rotation, clamped plate).
class Tissue {
 public:
  /// INVALID_ARGUMENT for a material out of bounds or a hexahedron with a non-positive Jacobian, naming it.
  static absl::StatusOr<Tissue> create(HexMesh mesh, std::vector<ElasticMaterial> materials, NodeSupports supports,
                                       RayleighDamping damping);

  const HexMesh& mesh() const;
  int n_dofs() const;
  /// Degree of freedom of component c of node a at 3 a + c; -1 where fixed.
  const std::vector<int>& dof_of_component() const;
  /// Lumped mass, a value a node [kg].
  const Eigen::VectorXd& mass() const;

  /// Brings rotations, internal force and stiffness to the positions `x` (3, n_nodes) [m].
  void assemble(const Eigen::Matrix3Xd& x, double dt);

  /// f_int of the last assemble, springs included, a value a degree of freedom [N].
  const Eigen::VectorXd& internal_force() const;

  /// K of the last assemble times a vector of degrees of freedom [N]; for damping forces.
  Eigen::VectorXd stiffness_times(const Eigen::VectorXd& v) const;

  /// S of the last assemble: its lower triangle, in a pattern that never changes (columns ascending, rows ascending in each).
  const Eigen::SparseMatrix<double>& system_matrix() const;

  /// Elastic energy of the last assemble, 1/2 sum_e d_e^T K_e d_e + springs  [J].
  double elastic_energy() const;

  /// Smallest det(F) over element centres at the last assemble; not positive: the element is turned inside out.
  double min_volume_ratio() const;

  const RayleighDamping& damping() const;
};

}  // namespace lipofill::solid
