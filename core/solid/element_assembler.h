#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "core/solid/element_batch.h"
#include "core/solid/hex_mesh.h"
#include "core/solid/material.h"
#include "core/solid/node_blocks.h"
#include "core/solid/system_pattern.h"

namespace lipofill::solid {

/// Sums over all hexahedra at some positions.
struct ElementTotals {
  double elastic_energy = 0.0;  ///< [J]
  double min_volume_ratio =
      0.0;                 ///< least det F at the centres, infinity without hexahedra, minus infinity when not finite
  bool is_folded = false;  ///< whether a corner's or a centre's volume is not positive, or not finite

  ElementTotals& operator+=(const ElementTotals& others) {
    elastic_energy += others.elastic_energy;
    min_volume_ratio = std::min(min_volume_ratio, others.min_volume_ratio);
    is_folded = is_folded || others.is_folded;
    return *this;
  }
};

/// The hexahedra of a tissue in batches, and where in the system their numbers go. Positions and
/// forces have four numbers a node here, a register each; the last has no meaning.
///
/// A batch takes hexahedra whose nodes are numbered in the same order, so that all lanes agree on
/// which blocks are stored transposed; meshes in layers have one such order. Sums go batch by
/// batch: they depend on the mesh alone. All is of Young's modulus 1 Pa; the moduli come with the
/// call. About 4.2 kB a hexahedron.
class ElementAssembler {
 public:
  /// The mesh and materials have been checked (tissue_checks.h).
  ElementAssembler(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials, const SystemPattern& pattern);

  /// Hands each hexahedron the Young's modulus of its material, in the order of the batches: what
  /// add and add_forces take.
  /// @param of_material  E [Pa], a value a material
  std::vector<double> spread_moduli(const HexMesh& mesh, const std::vector<double>& of_material) const;

  /// Adds sum_e R K_e (R^T x - X) to `force` (4, n_nodes) and lists in `squeezed` the hexahedra
  /// that the inversion barrier may have something to say about. Allocates nothing when that has
  /// room.
  ElementTotals add_forces(const std::vector<double>& moduli, const Eigen::Matrix4Xd& x, Eigen::Matrix4Xd& force,
                           std::vector<int>& squeezed) const;
  /// The same, the same bits, and adds sum_e R K_e R^T and K_G (geometric_stiffness.h) to `blocks`.
  ElementTotals add(const std::vector<double>& moduli, const Eigen::Matrix4Xd& x, Eigen::Matrix4Xd& force,
                    std::vector<int>& squeezed, NodeBlocks& blocks) const;

 private:
  using Lane = std::array<int, kLanes>;  ///< hexahedra of a batch, -1: left over

  void add_batch(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials, const SystemPattern& pattern,
                 const Lane& hexahedra);
  template <bool kWithStiffness>
  ElementTotals add_batches(const std::vector<double>& moduli, const Eigen::Matrix4Xd& x, Eigen::Matrix4Xd& force,
                            std::vector<int>& squeezed, double* blocks) const;

  std::vector<Lane> hexahedra_;
  std::vector<ElementBatch> forces_;
  std::vector<StiffnessBatch> stiffness_;
};

}  // namespace lipofill::solid
