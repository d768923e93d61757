#include "core/solid/neo_hookean_assembler.h"

#include <map>
#include <utility>

#include "core/solid/hexahedron_order.h"

namespace lipofill::solid {
namespace {

/// Neo-Hookean hexahedra by what a batch has in common, each list in the order of the mesh.
std::map<std::pair<bool, NodeOrder>, std::vector<int>> sort(const HexMesh& mesh,
                                                            const std::vector<ElasticMaterial>& materials) {
  std::map<std::pair<bool, NodeOrder>, std::vector<int>> sorted;
  for (int e = 0; e < mesh.n_hexahedra(); ++e) {
    if (materials[mesh.material[e]].law != TissueLaw::kNeoHookean) continue;
    sorted[{mesh.stacked[e], find_node_order(mesh.hexahedra[e])}].push_back(e);
  }
  return sorted;
}

}  // namespace

NeoHookeanAssembler::NeoHookeanAssembler(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials,
                                         const SystemPattern& pattern) {
  for (const auto& [kind, hexahedra] : sort(mesh, materials)) {
    for (size_t first = 0; first < hexahedra.size(); first += kLanes) {
      Lane lanes;
      for (size_t k = 0; k < kLanes; ++k) lanes[k] = first + k < hexahedra.size() ? hexahedra[first + k] : -1;
      add_batch(mesh, materials, pattern, lanes);
      batches_.back().is_stacked = kind.first;
      batches_.back().is_transposed = kind.second;
    }
  }
}

/// Lanes that are left over are copies of the first without stiffness.
void NeoHookeanAssembler::add_batch(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials,
                                    const SystemPattern& pattern, const Lane& hexahedra) {
  hexahedra_.push_back(hexahedra);
  NeoHookeanBatch& batch = batches_.emplace_back();
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool is_left_over = hexahedra[lane] < 0;
    const int e = is_left_over ? hexahedra[0] : hexahedra[lane];
    batch.set_lane(lane, mesh.hexahedra[e], mesh.gather(e, mesh.rest_positions),
                   materials[mesh.material[e]].poisson_ratio);
    if (is_left_over) batch.silence_lane(lane);
    for_each_node_pair([&](int a, int b, int pair) {
      batch.block[pair][lane] = is_left_over ? pattern.n_blocks()
                                             : pattern.find_block(mesh.hexahedra[e][kCornerOfBinary[a]],
                                                                  mesh.hexahedra[e][kCornerOfBinary[b]]);
    });
  }
}

/// Lanes that are left over take the modulus of the first.
std::vector<double> NeoHookeanAssembler::spread_moduli(const HexMesh& mesh,
                                                       const std::vector<double>& of_material) const {
  std::vector<double> moduli;
  moduli.reserve(kLanes * hexahedra_.size());
  for (const Lane& lanes : hexahedra_) {
    for (const int e : lanes) moduli.push_back(of_material[mesh.material[e < 0 ? lanes[0] : e]]);
  }
  return moduli;
}

template <bool kWithStiffness>
ElementTotals NeoHookeanAssembler::add_batches(const std::vector<double>& moduli, const Eigen::Matrix4Xd& x,
                                               Eigen::Matrix4Xd& force, std::vector<int>& squeezed,
                                               double* blocks) const {
  TotalsOfLanes totals;
  for (size_t k = 0; k < batches_.size(); ++k) {
    NeoHookeanPose pose;
    add_neo_hookean_forces(batches_[k], load(moduli.data() + kLanes * k), x.data(), pose, force.data());
    totals.add(pose.energy, pose.volume_ratio, pose.least_corner);
    list_squeezed(pose.least_corner, batches_[k].squeezed_corner, hexahedra_[k], squeezed);
    if (kWithStiffness) add_neo_hookean_stiffness(batches_[k], pose, blocks);
  }
  return totals.sum();
}

ElementTotals NeoHookeanAssembler::add_forces(const std::vector<double>& moduli, const Eigen::Matrix4Xd& x,
                                              Eigen::Matrix4Xd& force, std::vector<int>& squeezed) const {
  return add_batches<false>(moduli, x, force, squeezed, nullptr);
}

ElementTotals NeoHookeanAssembler::add(const std::vector<double>& moduli, const Eigen::Matrix4Xd& x,
                                       Eigen::Matrix4Xd& force, std::vector<int>& squeezed, NodeBlocks& blocks) const {
  return add_batches<true>(moduli, x, force, squeezed, blocks.data());
}

}  // namespace lipofill::solid
