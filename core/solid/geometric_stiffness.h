#pragma once

#include "core/solid/element_batch.h"

namespace lipofill::solid {

/// Stiffness that tension gives the tissue against turning: the initial-stress part of the tangent,
/// without which an inflated sheet seems softer than it is by an order of magnitude and Newton's
/// iteration on its shape diverges.
///
///     K_G(a, b) = sum_e V_e (grad N_a . S+ grad N_b) I,    S = lambda tr(E) I + 2 mu E,   E = (F^T F - I)/2
///
/// at element centres, with S+ the positive part of S: compression is left out, so that the system
/// matrix stays positive definite. It enters the matrix only, never the forces: converged states do
/// not depend on it.
///
/// @param modulus   Young's modulus, lambda and mu are proportional to it [Pa]
/// @param gradient  F at the centres
/// @param numbers   out: the factors of I [N/m], by node_pair
/// Decision record: core/doc/decisions/003-stiffness-of-tension.md. Checked by
/// tests/unit/solid/geometric_stiffness_test.cc.
void compute_geometric_stiffness(const ElementBatch& batch, const Lanes& modulus, const LaneMatrix3& gradient,
                                 Lanes (&numbers)[kNodePairs]);

/// The symmetric matrix of entries (00, 11, 22, 01, 12, 20) with its negative eigenvalues set to
/// zero, by Jacobi's rotations.
void take_positive_part(Lanes (&symmetric)[6]);

/// The positive part of `stress` - c I, in its place, and c: of the values between the least and
/// the largest principal stress the one nearest to zero.
Lanes take_tension(Lanes (&stress)[6]);

}  // namespace lipofill::solid
