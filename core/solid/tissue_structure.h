#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/solid/element_assembler.h"
#include "core/solid/hex_mesh.h"
#include "core/solid/inversion_barrier.h"
#include "core/solid/material.h"
#include "core/solid/neo_hookean_assembler.h"
#include "core/solid/prestress.h"
#include "core/solid/system_pattern.h"
#include "core/solid/wall_springs.h"

namespace lipofill::solid {

/// The supports of the nodes. Nodes may be in several entries; fixed wins over springs.
struct NodeSupports {
  std::vector<std::array<bool, 3>> fixed;  ///< a triple a node: x, y, z held at rest; empty: none held
  std::vector<double> spring;              ///< isotropic spring to the rest position, a value a node [N/m]; empty: none
};

/// The parts of a tissue that never change: its mesh, numbering, element matrices and springs.
/// Young's moduli do change: element matrices are of 1 Pa, and each tissue multiplies them by its
/// own. Tissues share a structure (tissue.h); nothing in it is written once it is made, so threads
/// may.
class TissueStructure {
 public:
  /// Creates the structure. INVALID_ARGUMENT with a violation each for sizes that disagree, a node
  /// index out of range or a node in no hexahedron, a position that is not finite, a material or
  /// spring out of bounds, a hexahedron with a non-positive Jacobian at a corner or Gauss point,
  /// naming it. Checked by tests/unit/solid/tissue_checks_test.cc.
  static absl::StatusOr<std::shared_ptr<const TissueStructure>> create(HexMesh mesh,
                                                                       const std::vector<ElasticMaterial>& materials,
                                                                       NodeSupports supports,
                                                                       const std::vector<WallSpring>& springs = {});

  TissueStructure(const TissueStructure&) = delete;
  TissueStructure& operator=(const TissueStructure&) = delete;

  /// A node that a spring holds, and where its values are on the diagonal, -1: fixed.
  struct SprungNode {
    int node;
    double stiffness;  ///< [N/m]
    std::array<int, 3> diagonal;
  };

  const HexMesh& mesh() const { return mesh_; }
  int n_materials() const { return n_materials_; }
  const SystemPattern& pattern() const { return pattern_; }
  const ElementAssembler& elements() const { return elements_; }
  const NeoHookeanAssembler& neo_hookean() const { return neo_hookean_; }
  const Prestress& prestress() const { return prestress_; }
  const InversionBarrier& barrier() const { return barrier_; }
  const WallSprings& springs() const { return springs_; }
  const std::vector<SprungNode>& sprung_nodes() const { return sprung_nodes_; }
  /// Lumped mass, a value a node [kg].
  const Eigen::VectorXd& mass() const { return mass_; }
  /// Mass of the node of each degree of freedom [kg], and where its value on the diagonal is.
  const Eigen::VectorXd& dof_mass() const { return dof_mass_; }
  const std::vector<int>& diagonal() const { return diagonal_; }

 private:
  TissueStructure(HexMesh mesh, const std::vector<ElasticMaterial>& materials, const NodeSupports& supports,
                  const std::vector<WallSpring>& springs);
  void lump_mass(const std::vector<ElasticMaterial>& materials);
  void find_diagonal(const NodeSupports& supports);

  HexMesh mesh_;
  int n_materials_;
  SystemPattern pattern_;
  ElementAssembler elements_;
  NeoHookeanAssembler neo_hookean_;
  Prestress prestress_;
  InversionBarrier barrier_;
  WallSprings springs_;
  std::vector<SprungNode> sprung_nodes_;
  Eigen::VectorXd mass_;
  Eigen::VectorXd dof_mass_;
  std::vector<int> diagonal_;
};

}  // namespace lipofill::solid
