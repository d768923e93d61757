#pragma once

#include <Eigen/Core>

#include "core/solid/hex_mesh.h"
#include "core/solid/hex_shape.h"
#include "core/solid/node_blocks.h"
#include "core/solid/system_pattern.h"

namespace lipofill::solid {

/// Keeps hexahedra from turning inside out. Linear elasticity resists the trace of the strain, not
/// the loss of volume: a nearly incompressible element that is stretched to twice its width gives
/// way to nothing in the third direction at a finite force. Real tissue does not: its pressure
/// grows without bound. So each corner of each element has the energy
///
///     V_e/8 E b(j),   j = J/J_0,   J = det[e_1 e_2 e_3] / (the same at rest)     e: the three edges of the corner
///     b(j) = -(j - 1)^2 ln j  for j < 1,  else 0                                 twice differentiable at j = 1
///
/// (the barrier of Li et al. 2020, Incremental Potential Contact, on volumes), with E Young's
/// modulus and J_0 = kThreshold: nothing at all changes where every corner keeps that share of its
/// volume. Below j = kLeastShare b goes on as the parabola that touches it, so that an iterate of
/// Newton's method that is inside out is driven back; states that are inside out stay invalid. The
/// tangent is the positive semi-definite part of each corner's (9, 9) second derivative by its
/// edges. Decision record: core/doc/decisions/006-inversion-barrier.md.
/// Checked by tests/unit/solid/inversion_barrier_test.cc.
class InversionBarrier {
 public:
  static constexpr double kThreshold = 0.3;    ///< J_0
  static constexpr double kLeastShare = 0.05;  ///< of j

  /// The mesh must outlive the barrier.
  explicit InversionBarrier(const HexMesh& mesh) : mesh_(&mesh) {}

  /// Largest det[e_1 e_2 e_3] of a hexahedron's corners [m3]: where no corner has less than
  /// kThreshold times that of the rest shape, there is no barrier.
  static double find_largest_corner(const HexNodes& nodes);

  /// Adds the force of a hexahedron at the positions `x` (4, n_nodes; the last row has no meaning)
  /// to `force` (4, n_nodes); returns the energy [J]. Allocates nothing, as does add_tangent.
  /// @param youngs_modulus  E of the hexahedron [Pa]
  double add_force(int hexahedron, double youngs_modulus, const Eigen::Matrix4Xd& x, Eigen::Matrix4Xd& force) const;
  void add_tangent(int hexahedron, double youngs_modulus, const Eigen::Matrix4Xd& x, const SystemPattern& pattern,
                   TangentValues& values) const;

 private:
  struct Corner {
    int index;
    Eigen::Matrix3d edges;
    double inverse_rest;  ///< 1/(J_0 det[e_1 e_2 e_3]) at rest [1/m3]
    double modulus;       ///< E V_e/8 [J]
  };
  template <typename Visit>
  void for_each_squeezed_corner(int hexahedron, double youngs_modulus, const Eigen::Matrix4Xd& x, Visit visit) const;

  const HexMesh* mesh_;
};

}  // namespace lipofill::solid
