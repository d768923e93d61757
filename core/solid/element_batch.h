#pragma once

#include <Eigen/Core>
#include <array>

#include "core/solid/hex_shape.h"

namespace lipofill::solid {

inline constexpr int kLanes = 4;

/// A number of each of kLanes hexahedra, worked on side by side.
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double)), aligned(kLanes * sizeof(double))));
struct alignas(kLanes * sizeof(double)) LaneMatrix3 {
  Lanes m[3][3];
};

/// Pairs (a, b) of element nodes with a >= b: the blocks of the lower triangle of an element matrix.
inline constexpr int kNodePairs = 36;
constexpr int node_pair(int a, int b) {
  return a * (a + 1) / 2 + b;
}

/// What stays constant of kLanes hexahedra.
struct alignas(kLanes * sizeof(double)) ElementBatch {
  LaneMatrix3 stiffness[kNodePairs];  ///< blocks of K_e [N/m]
  LaneMatrix3 inverse_jacobian;       ///< at the centre, at rest [1/m]
  Lanes rest[8][3];                   ///< X_a less the mean of the nodes [m]
  int nodes[kLanes][8];

  /// `positions` (3, 8) at rest, `K` (24, 24) symmetric.
  void set_lane(int lane, const std::array<int, 8>& hexahedron, const HexNodes& positions, const HexStiffness& K);
};

/// What assembly needs of kLanes hexahedra at some positions.
struct alignas(kLanes * sizeof(double)) BatchResult {
  LaneMatrix3 stiffness[kNodePairs];  ///< blocks of R K_e R^T [N/m]
  Lanes force[8][3];                  ///< R K_e (R^T x - X) [N]
  Lanes energy;                       ///< 1/2 d^T K_e d, d = R^T x - X [J]
  Lanes volume_ratio;                 ///< det F at the centre
};

/// Rotates kLanes hexahedra from rest to the positions `x` (3, n_nodes) [m].
///
/// R by Newton's iteration R <- (R + R^-T)/2 from F (Higham 1986); lanes where that is slow, det F small or negative,
/// by compute_nearest_rotation. Depends on x alone, not on earlier calls, and gives the same bits on every x86
/// processor: lanes are wider with AVX2, but no operation is fused or reordered. Checked by
/// tests/unit/solid/tissue_test.cc against a dense assembly.
void compute_batch(const ElementBatch& batch, const Eigen::Matrix3Xd& x, BatchResult& result);

/// Force, energy and volume ratio alone, the same bits; leaves the stiffness of `result` as it is.
void compute_batch_force(const ElementBatch& batch, const Eigen::Matrix3Xd& x, BatchResult& result);

/// compute_batch, bit for bit, in the registers that every processor of the family has.
void compute_batch_portable(const ElementBatch& batch, const Eigen::Matrix3Xd& x, BatchResult& result);

}  // namespace lipofill::solid
