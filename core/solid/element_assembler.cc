#include "core/solid/element_assembler.h"

#include <algorithm>
#include <cmath>

#include "core/solid/incompatible_modes.h"
#include "core/solid/solid_shell.h"

namespace lipofill::solid {
namespace {

HexStiffness compute_stiffness(const HexMesh& mesh, int hexahedron, const std::vector<ElasticMaterial>& materials) {
  const HexNodes nodes = mesh.gather(hexahedron, mesh.rest_positions);
  const auto D = compute_elasticity_matrix(materials[mesh.material[hexahedron]]);
  return mesh.stacked[hexahedron] ? compute_incompatible_modes_stiffness(nodes, D)
                                  : compute_solid_shell_stiffness(nodes, D);
}

}  // namespace

ElementAssembler::ElementAssembler(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials,
                                   const SystemPattern& pattern)
    : n_hexahedra_(mesh.n_hexahedra()) {
  const int n_batches = (n_hexahedra_ + kLanes - 1) / kLanes;
  batches_.resize(n_batches);
  for (int k = 0; k < n_batches; ++k) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const int e = std::min(k * kLanes + lane, n_hexahedra_ - 1);  // the last batch is filled up with copies
      batches_[k].set_lane(lane, mesh.hexahedra[e], mesh.gather(e, mesh.rest_positions),
                           compute_stiffness(mesh, e, materials));
    }
    scatters_.push_back(make_scatter(mesh, pattern, k * kLanes));
  }
}

ElementAssembler::Scatter ElementAssembler::make_scatter(const HexMesh& mesh, const SystemPattern& pattern,
                                                         int first_hexahedron) {
  const auto nowhere = static_cast<std::int32_t>(pattern.matrix().nonZeros());
  Scatter scatter;
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool padding = first_hexahedron + lane >= mesh.n_hexahedra();
    const auto dof = [&](int a, int c) {
      return padding ? -1 : pattern.dof_of_component()[3 * mesh.hexahedra[first_hexahedron + lane][a] + c];
    };
    for (int a = 0; a < 8; ++a) {
      for (int i = 0; i < 3; ++i) {
        scatter.force[a][i][lane] = dof(a, i) < 0 ? pattern.n_dofs() : dof(a, i);
        for (int column = 0; column < 3 * (a + 1); ++column) {
          const int b = column / 3;
          const int j = column % 3;
          const bool kept = dof(a, i) >= 0 && dof(b, j) >= 0 && (a != b || i >= j);
          scatter.stiffness[node_pair(a, b)][i][j][lane] = kept ? pattern.find(dof(a, i), dof(b, j)) : nowhere;
        }
      }
    }
  }
  return scatter;
}

/// @param compute  (batch index, result): fills at least force, energy and volume ratio
template <typename Compute>
ElementTotals ElementAssembler::add_batches(const Compute& compute, Eigen::VectorXd& force) const {
  ElementTotals totals;
  totals.min_volume_ratio = HUGE_VAL;
  BatchResult result;
  for (size_t k = 0; k < batches_.size(); ++k) {
    compute(k, result);
    scatter_force(result, scatters_[k], force.data());
    const int lanes = std::min(kLanes, n_hexahedra_ - static_cast<int>(k) * kLanes);
    for (int lane = 0; lane < lanes; ++lane) {
      const double ratio = result.volume_ratio[lane];
      totals.elastic_energy += result.energy[lane];
      totals.min_volume_ratio = std::min(totals.min_volume_ratio, std::isfinite(ratio) ? ratio : -HUGE_VAL);
    }
  }
  return totals;
}

ElementTotals ElementAssembler::add(const Eigen::Matrix3Xd& x, Eigen::VectorXd& stiffness,
                                    Eigen::VectorXd& force) const {
  return add_batches(
      [&](size_t k, BatchResult& result) {
        compute_batch(batches_[k], x, result);
        scatter_stiffness(result, scatters_[k], stiffness.data());
      },
      force);
}

ElementTotals ElementAssembler::add_force(const Eigen::Matrix3Xd& x, Eigen::VectorXd& force) const {
  return add_batches([&](size_t k, BatchResult& result) { compute_batch_force(batches_[k], x, result); }, force);
}

void ElementAssembler::scatter_stiffness(const BatchResult& result, const Scatter& scatter, double* values) {
  for (int pair = 0; pair < kNodePairs; ++pair) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const Lanes& value = result.stiffness[pair].m[i][j];
        for (int lane = 0; lane < kLanes; ++lane) values[scatter.stiffness[pair][i][j][lane]] += value[lane];
      }
    }
  }
}

void ElementAssembler::scatter_force(const BatchResult& result, const Scatter& scatter, double* force) {
  for (int a = 0; a < 8; ++a) {
    for (int c = 0; c < 3; ++c) {
      for (int lane = 0; lane < kLanes; ++lane) force[scatter.force[a][c][lane]] += result.force[a][c][lane];
    }
  }
}

}  // namespace lipofill::solid
