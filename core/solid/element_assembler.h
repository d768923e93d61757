#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/solid/element_batch.h"
#include "core/solid/hex_mesh.h"
#include "core/solid/material.h"
#include "core/solid/system_pattern.h"

namespace lipofill::solid {

/// Sums over all hexahedra at some positions.
struct ElementTotals {
  double elastic_energy = 0.0;  ///< [J]
  double min_volume_ratio =
      0.0;  ///< least det F at the centres, infinity without hexahedra, minus infinity when not finite
};

/// The hexahedra of a tissue in batches, and where in the system each of their numbers goes.
class ElementAssembler {
 public:
  /// The mesh and materials have been checked (tissue_checks.h).
  ElementAssembler(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials, const SystemPattern& pattern);

  /// Adds sum_e R K_e R^T to `stiffness` (one value a value of the pattern) and sum_e R K_e (R^T x - X) to `force`
  /// (n_dofs); both have one more entry at their end, which collects what is fixed. Allocates nothing; sums in the
  /// order of the mesh.
  ElementTotals add(const Eigen::Matrix3Xd& x, Eigen::VectorXd& stiffness, Eigen::VectorXd& force) const;
  /// The force alone, the same bits, at half the cost.
  ElementTotals add_force(const Eigen::Matrix3Xd& x, Eigen::VectorXd& force) const;

 private:
  struct Scatter {
    std::int32_t stiffness[kNodePairs][3][3][kLanes];
    std::int32_t force[8][3][kLanes];
  };

  static Scatter make_scatter(const HexMesh& mesh, const SystemPattern& pattern, int first_hexahedron);
  template <typename Compute>
  ElementTotals add_batches(const Compute& compute, Eigen::VectorXd& force) const;
  static void scatter_stiffness(const BatchResult& result, const Scatter& scatter, double* values);
  static void scatter_force(const BatchResult& result, const Scatter& scatter, double* force);

  int n_hexahedra_;
  std::vector<ElementBatch> batches_;
  std::vector<Scatter> scatters_;
};

}  // namespace lipofill::solid
