#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/solid/hex_mesh.h"
#include "core/solid/material.h"
#include "core/solid/system_pattern.h"

namespace lipofill::solid {

/// Keeps hexahedra from turning inside out. Linear elasticity resists the trace of the strain, not the loss of volume:
/// a nearly incompressible element that is stretched to twice its width gives way to nothing in the third direction at
/// a finite force. Real tissue does not: its pressure grows without bound. So each corner of each element has the
/// energy
///
///     V_e/8 E b(j),   j = J/J_0,   J = det[e_1 e_2 e_3] / (the same at rest)     e: the three edges of the corner
///     b(j) = -(j - 1)^2 ln j  for j < 1,  else 0                                 twice differentiable at j = 1
///
/// (the barrier of Li et al. 2020, Incremental Potential Contact, on volumes), with E Young's modulus and J_0 =
/// kThreshold: nothing at all changes where every corner keeps that share of its volume. Below j = kLeastShare b goes
/// on as the parabola that touches it, so that an iterate of Newton's method that is inside out is driven back;
/// states that are inside out stay invalid. The tangent is the positive semi-definite part of each corner's (9, 9)
/// second derivative by its edges. Decision record: core/doc/decisions/006-inversion-barrier.md.
/// Checked by tests/unit/solid/inversion_barrier_test.cc.
class InversionBarrier {
 public:
  static constexpr double kThreshold = 0.3;    ///< J_0
  static constexpr double kLeastShare = 0.05;  ///< of j

  InversionBarrier(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials);

  /// Adds the tangent at the positions `x` to values in the order of `pattern`, the force to the n_dofs first entries
  /// of `force`; returns the energy [J]. Allocates nothing.
  double add(const Eigen::Matrix3Xd& x, const SystemPattern& pattern, Eigen::VectorXd& values,
             Eigen::VectorXd& force) const;

 private:
  struct Element {
    std::array<int, 8> nodes;
    double modulus;                      ///< E V_e/8 [J]
    std::array<double, 8> inverse_rest;  ///< 1/(J_0 det[e_1 e_2 e_3]) at rest [1/m3]
  };
  double add_corner(const Element& element, int corner, const Eigen::Matrix3d& edges, const SystemPattern& pattern,
                    Eigen::VectorXd& values, Eigen::VectorXd& force) const;

  std::vector<Element> elements_;
};

}  // namespace lipofill::solid
