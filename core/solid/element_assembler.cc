#include "core/solid/element_assembler.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "core/solid/geometric_stiffness.h"
#include "core/solid/hexahedron_order.h"
#include "core/solid/incompatible_modes.h"
#include "core/solid/inversion_barrier.h"
#include "core/solid/solid_shell.h"

namespace lipofill::solid {
namespace {

ElasticMaterial at_unit_modulus(ElasticMaterial material) {
  material.youngs_modulus = 1.0;
  return material;
}

/// The stiffness of a batch's hexahedra at 1 Pa; lanes that are left over have none.
std::array<HexStiffness, kLanes> compute_unit_stiffness(const HexMesh& mesh,
                                                        const std::vector<ElasticMaterial>& materials,
                                                        const std::array<int, kLanes>& hexahedra) {
  std::array<HexNodes, kLanes> nodes;
  std::array<ElasticityMatrix, kLanes> D;
  bool is_any_a_shell = false;
  for (int lane = 0; lane < kLanes; ++lane) {
    const int e = hexahedra[lane] < 0 ? hexahedra[0] : hexahedra[lane];
    nodes[lane] = mesh.gather(e, mesh.rest_positions);
    D[lane] = compute_elasticity_matrix(at_unit_modulus(materials[mesh.material[e]]));
    is_any_a_shell = is_any_a_shell || !mesh.stacked[e];
  }
  std::array<HexStiffness, kLanes> stiffness;
  if (is_any_a_shell) compute_solid_shell_stiffness(nodes, D, stiffness);
  for (int lane = 0; lane < kLanes; ++lane) {
    const int e = hexahedra[lane];
    if (e < 0) {
      stiffness[lane].setZero();
    } else if (mesh.stacked[e]) {
      stiffness[lane] = compute_incompatible_modes_stiffness(nodes[lane], D[lane]);
    }
  }
  return stiffness;
}

/// Hexahedra by the order of their nodes, each list in the order of the mesh.
std::map<NodeOrder, std::vector<int>> sort_by_order(const HexMesh& mesh,
                                                    const std::vector<ElasticMaterial>& materials) {
  std::map<NodeOrder, std::vector<int>> sorted;
  for (int e = 0; e < mesh.n_hexahedra(); ++e) {
    if (materials[mesh.material[e]].law != TissueLaw::kCorotational) continue;
    sorted[find_node_order(mesh.hexahedra[e])].push_back(e);
  }
  return sorted;
}

void set_tension(const HexMesh& mesh, int e, const ElasticMaterial& material, int lane, ElementBatch& batch) {
  const HexNodes rest = mesh.gather(e, mesh.rest_positions);
  const double volume = 8.0 * compute_jacobian(rest, LocalPoint::Zero()).determinant();
  const double nu = material.poisson_ratio;
  batch.lambda[lane] = volume * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  batch.mu[lane] = volume / (2.0 * (1.0 + nu));
  batch.squeezed_corner[lane] = InversionBarrier::kThreshold * InversionBarrier::find_largest_corner(rest);
}

}  // namespace

ElementAssembler::ElementAssembler(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials,
                                   const SystemPattern& pattern) {
  const auto sorted = sort_by_order(mesh, materials);
  size_t n_batches = 0;
  for (const auto& [order, hexahedra] : sorted) n_batches += (hexahedra.size() + kLanes - 1) / kLanes;
  hexahedra_.reserve(n_batches);
  forces_.reserve(n_batches);
  stiffness_.reserve(n_batches);
  for (const auto& [order, hexahedra] : sorted) {
    for (size_t first = 0; first < hexahedra.size(); first += kLanes) {
      Lane lanes;
      for (size_t k = 0; k < kLanes; ++k) lanes[k] = first + k < hexahedra.size() ? hexahedra[first + k] : -1;
      add_batch(mesh, materials, pattern, lanes);
      stiffness_.back().is_transposed = order;
    }
  }
}

/// Lanes that are left over are copies of the first without stiffness.
void ElementAssembler::add_batch(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials,
                                 const SystemPattern& pattern, const Lane& hexahedra) {
  hexahedra_.push_back(hexahedra);
  ElementBatch& force = forces_.emplace_back();
  StiffnessBatch& stiffness = stiffness_.emplace_back();
  const std::array<HexStiffness, kLanes> unit_stiffness = compute_unit_stiffness(mesh, materials, hexahedra);
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool is_left_over = hexahedra[lane] < 0;
    const int e = is_left_over ? hexahedra[0] : hexahedra[lane];
    const HexStiffness& K = unit_stiffness[lane];
    force.set_lane(lane, mesh.hexahedra[e], mesh.gather(e, mesh.rest_positions), K);
    set_tension(mesh, e, materials[mesh.material[e]], lane, force);
    stiffness.set_lane(lane, K);
    for_each_node_pair([&](int a, int b, int pair) {
      stiffness.block[pair][lane] = is_left_over ? pattern.n_blocks()
                                                 : pattern.find_block(mesh.hexahedra[e][kCornerOfBinary[a]],
                                                                      mesh.hexahedra[e][kCornerOfBinary[b]]);
    });
  }
}

/// Lanes that are left over take the modulus of the first.
std::vector<double> ElementAssembler::spread_moduli(const HexMesh& mesh, const std::vector<double>& of_material) const {
  std::vector<double> moduli;
  moduli.reserve(kLanes * hexahedra_.size());
  for (const Lane& lanes : hexahedra_) {
    for (const int e : lanes) moduli.push_back(of_material[mesh.material[e < 0 ? lanes[0] : e]]);
  }
  return moduli;
}

template <bool kWithStiffness>
ElementTotals ElementAssembler::add_batches(const std::vector<double>& moduli, const Eigen::Matrix4Xd& x,
                                            Eigen::Matrix4Xd& force, std::vector<int>& squeezed, double* blocks) const {
  TotalsOfLanes totals;
  for (size_t k = 0; k < forces_.size(); ++k) {
    ElementPose pose;
    const Lanes modulus = load(moduli.data() + kLanes * k);
    add_element_forces(forces_[k], modulus, x.data(), pose, force.data());
    totals.add(pose.energy, pose.volume_ratio, pose.least_corner);
    list_squeezed(pose.least_corner, forces_[k].squeezed_corner, hexahedra_[k], squeezed);
    if (!kWithStiffness) continue;
    Lanes geometric[kNodePairs];
    compute_geometric_stiffness(forces_[k], modulus, pose.gradient, geometric);
    const StiffnessBatch& next = stiffness_[std::min(k + 1, stiffness_.size() - 1)];
    add_element_stiffness(stiffness_[k], next, pose, geometric, blocks);
  }
  return totals.sum();
}

ElementTotals ElementAssembler::add_forces(const std::vector<double>& moduli, const Eigen::Matrix4Xd& x,
                                           Eigen::Matrix4Xd& force, std::vector<int>& squeezed) const {
  return add_batches<false>(moduli, x, force, squeezed, nullptr);
}

ElementTotals ElementAssembler::add(const std::vector<double>& moduli, const Eigen::Matrix4Xd& x,
                                    Eigen::Matrix4Xd& force, std::vector<int>& squeezed, NodeBlocks& blocks) const {
  return add_batches<true>(moduli, x, force, squeezed, blocks.data());
}

}  // namespace lipofill::solid
