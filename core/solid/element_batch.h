#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "core/base/lanes.h"
#include "core/solid/hex_shape.h"

namespace lipofill::solid {

struct LaneMatrix3 {
  Lanes m[3][3];
};

/// Pairs (a, b) of element nodes with a >= b: the blocks of the lower triangle of an element
/// matrix.
inline constexpr int kNodePairs = 36;
constexpr int node_pair(int a, int b) {
  return a * (a + 1) / 2 + b;
}

/// Batches take the nodes of a hexahedron in binary order, bit k of an index for the side along
/// local coordinate k: corner_of_binary[b] is the place of node b in HexMesh.
inline constexpr std::array<int, 8> kCornerOfBinary = {0, 1, 3, 2, 4, 5, 7, 6};

/// Independent numbers of the modal stiffness, 3 x 3 block row by block row: the diagonal block's
/// lower triangle, then the blocks left of it.
inline constexpr int kModalNumbers = 171;
/// Independent numbers of the lower blocks of an element matrix.
inline constexpr int kStiffnessNumbers = 300;

/// The data that the forces of kLanes hexahedra need. With h_k the products of local coordinates
/// (the Hadamard basis of the eight nodes), s_k = sum_b h_k(b) x_b, the pose of an element is told
/// by
///
///     F = [s_1 s_2 s_4] J_0^-1/8       gradient at the centre
///     q = (R^T F - I in Voigt order, shear doubled;  R^T s_k - S_k for the four hourglass modes k = 3, 5, 6, 7)
///
/// the 18 numbers besides rigid motion, which K_e cannot see: K_e d = A^T K_q q for d = R^T x - X.
/// K_q (18, 18) has 171 numbers where K_e has 300; what a force costs is reading them. Everything
/// is of Young's modulus 1 Pa: the modulus is a factor that comes with the call.
struct ElementBatch {
  Lanes modal_stiffness[kModalNumbers];  ///< K_q / E
  Lanes inverse_jacobian[3][3];          ///< J_0^-1/8 at the centre, at rest [1/m]
  Lanes rest_hourglass[4][3];            ///< S_k [m]
  Lanes lambda, mu;                      ///< Lame's constants times volume / E [m3]
  Lanes squeezed_corner;                 ///< a corner's volume below this may be one for the inversion barrier [m3]
  int nodes[8][kLanes];                  ///< in binary order

  /// `positions` (3, 8) at rest and `K` (24, 24) at 1 Pa, nodes in the order of HexMesh.
  void set_lane(int lane, const std::array<int, 8>& hexahedron, const HexNodes& positions, const HexStiffness& K);
};

/// The data that the tangent needs in addition: the lower blocks of K_e at 1 Pa, nodes in binary
/// order, and their places in the pattern.
struct StiffnessBatch {
  /// Lower blocks of K_e / E [m] in the order in which they are read: of each node a the blocks (a,
  /// b), b < a, then the lower triangle of (a, a).
  Lanes numbers[kStiffnessNumbers];
  std::int32_t block[kNodePairs][kLanes];  ///< in NodeBlocks
  /// Pairs a > b whose block is stored as (b, a): node b of the mesh comes after node a. The same
  /// in all lanes.
  std::array<bool, kNodePairs> is_transposed;

  void set_lane(int lane, const HexStiffness& K);
};

/// Intermediate values of kLanes hexahedra, computed on the way to their forces.
struct ElementPose {
  LaneMatrix3 gradient;        ///< F at the centre
  LaneMatrix3 rotation;        ///< R
  LaneMatrix3 stiff_rotation;  ///< E R [Pa]: where R stands once in a product with K_e, this brings the modulus in
  Lanes volume_ratio;          ///< det F at the centre
  Lanes least_corner;          ///< least over the corners of det[e_1 e_2 e_3] [m3]
  Lanes energy;                ///< 1/2 q^T K_q q [J]
};

/// Adds R K_e (R^T x - X) to `force`; `x` and `force` hold four numbers a node, the last of no
/// meaning.
///
/// R by Newton's iteration R <- (R + R^-T)/2 from F (Higham 1986); lanes where that is slow, det F
/// small or negative, by compute_nearest_rotation. Depends on x alone, not on earlier calls.
/// Checked by tests/unit/solid/element_batch_test.cc and tissue_test.cc against the definition.
/// @param modulus  E [Pa]
void add_element_forces(const ElementBatch& batch, const Lanes& modulus, const double* x, ElementPose& pose,
                        double* force);

/// Adds R K_e R^T, and `geometric` (one number a pair of nodes, for K_G = number I), to blocks in
/// the layout of NodeBlocks.
/// @param next  the batch that comes after it, to be fetched meanwhile
void add_element_stiffness(const StiffnessBatch& batch, const StiffnessBatch& next, const ElementPose& pose,
                           const Lanes (&geometric)[kNodePairs], double* blocks);

}  // namespace lipofill::solid
