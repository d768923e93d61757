#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/solid/hex_mesh.h"
#include "core/solid/material.h"
#include "core/solid/system_pattern.h"

namespace lipofill::solid {

/// Stiffness that tension gives the tissue against turning: the initial-stress part of the tangent, without which an
/// inflated sheet seems softer than it is by an order of magnitude and Newton's iteration on its shape diverges.
///
///     K_G(a, b) = sum_e V_e (grad N_a . S+ grad N_b) I,    S = lambda tr(E) I + 2 mu E,   E = (F^T F - I)/2
///
/// at element centres, with S+ the positive part of S: compression is left out, so that the system matrix stays
/// positive definite. It enters the matrix only, never the forces: converged states do not depend on it. Checked by
/// tests/unit/solid/geometric_stiffness_test.cc.
class GeometricStiffness {
 public:
  GeometricStiffness(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials, const SystemPattern& pattern);

  /// Adds K_G at the positions `x` to values in the pattern's order.
  void add(const Eigen::Matrix3Xd& x, Eigen::VectorXd& values) const;

 private:
  struct Element {
    std::array<int, 8> nodes;
    Eigen::Matrix<double, 3, 8> gradient;  ///< of the shape functions at the centre, at rest [1/m]
    double volume;                         ///< [m3]
    double lambda;                         ///< [Pa]
    double mu;                             ///< [Pa]
    /// Where entry c of the diagonal of block (a, b), a >= b, goes; -1 where a component is fixed.
    std::array<std::array<int, 3>, 36> targets;
  };
  std::vector<Element> elements_;
};

}  // namespace lipofill::solid
