#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/solid/element_assembler.h"
#include "core/solid/neo_hookean_batch.h"

namespace lipofill::solid {

/// The neo-Hookean hexahedra of a tissue in batches, as ElementAssembler holds the corotational
/// ones. A batch takes hexahedra that are all stacked or none, with nodes numbered in the same
/// order. All is of Young's modulus 1 Pa; the moduli come with the call. About 600 B a hexahedron.
/// Checked by tests/unit/solid/neo_hookean_test.cc.
class NeoHookeanAssembler {
 public:
  /// The mesh and materials have been checked (tissue_checks.h).
  NeoHookeanAssembler(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials, const SystemPattern& pattern);

  /// Young's moduli [Pa] of the materials, in the order in which the batches take them.
  std::vector<double> spread_moduli(const HexMesh& mesh, const std::vector<double>& of_material) const;

  /// Adds the forces to `force` (4, n_nodes) and lists in `squeezed` the hexahedra that the
  /// inversion barrier may have something to say about. Allocates nothing when that has room.
  /// @param moduli  of spread_moduli
  ElementTotals add_forces(const std::vector<double>& moduli, const Eigen::Matrix4Xd& x, Eigen::Matrix4Xd& force,
                           std::vector<int>& squeezed) const;
  /// The same, the same bits, and adds the tangent to `blocks`.
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
  std::vector<NeoHookeanBatch> batches_;
};

}  // namespace lipofill::solid
