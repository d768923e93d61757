#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/solid/tissue.h"

namespace lipofill::solid::testing {

/// Displacements (3, n_nodes) of the linear problem K u = f at rest, fixed components zero.
Eigen::Matrix3Xd solve_linear(Tissue& tissue, const Eigen::Matrix3Xd& force);

/// Displacements of the linear problem K u = 0 at rest where the nodes `held` keep what
/// `prescribed` gives them. The tissue has no supports of its own.
Eigen::Matrix3Xd solve_prescribed(Tissue& tissue, const std::vector<bool>& held, const Eigen::Matrix3Xd& prescribed);

struct StaticState {
  Eigen::Matrix3Xd x;
  int iterations = 0;
  bool converged = false;
};

/// f_int(x) = f by Newton's method in `n_increments` of the load, to a relative residual of 1e-8.
/// For small meshes: the Jacobian is dense, by central differences, since K leaves out how the
/// rotations change with x.
StaticState solve_static(Tissue& tissue, const Eigen::Matrix3Xd& force, int n_increments);

/// What a solid that may deform by any amount is subject to.
struct LargeDeformation {
  std::vector<std::array<bool, 3>> held;  ///< components of the nodes that go where `prescribed` says
  Eigen::Matrix3Xd prescribed;            ///< positions [m] (3, n_nodes)
  Eigen::Matrix3Xd force;                 ///< dead load on the others [N] (3, n_nodes)
};

/// Finds the minimum of energy - force . x in `n_increments` of what is prescribed, by Newton's
/// method with the tissue's own tangent and steps halved until the energy falls, to a relative
/// residual of 1e-9. The tissue has no supports; after that its internal_force() holds the
/// reactions.
StaticState solve_large_deformation(Tissue& tissue, const LargeDeformation& problem, int n_increments);

/// Smallest eigenfrequency of K phi = (2 pi f)^2 M phi [Hz], by inverse iteration from a uniform
/// lift.
double compute_first_frequency(Tissue& tissue);

}  // namespace lipofill::solid::testing
