#include "core/solid/tissue_structure.h"

#include <Eigen/LU>
#include <utility>

#include "core/solid/hex_shape.h"
#include "core/solid/tissue_checks.h"

namespace lipofill::solid {

absl::StatusOr<std::shared_ptr<const TissueStructure>> TissueStructure::create(
    HexMesh mesh, const std::vector<ElasticMaterial>& materials, NodeSupports supports,
    const std::vector<WallSpring>& springs) {
  if (supports.fixed.empty()) supports.fixed.resize(mesh.n_nodes(), {false, false, false});
  if (supports.spring.empty()) supports.spring.resize(mesh.n_nodes(), 0.0);
  if (absl::Status status = check_tissue(mesh, materials, supports, springs); !status.ok()) return status;
  return std::shared_ptr<const TissueStructure>(new TissueStructure(std::move(mesh), materials, supports, springs));
}

TissueStructure::TissueStructure(HexMesh mesh, const std::vector<ElasticMaterial>& materials,
                                 const NodeSupports& supports, const std::vector<WallSpring>& springs)
    : mesh_(std::move(mesh)),
      n_materials_(static_cast<int>(materials.size())),
      pattern_(mesh_.n_nodes(), mesh_.hexahedra, supports.fixed, collect_coupled_nodes(springs)),
      elements_(mesh_, materials, pattern_),
      prestress_(mesh_, materials, pattern_),
      barrier_(mesh_),
      springs_(springs, mesh_.rest_positions, pattern_) {
  lump_mass(materials);
  find_diagonal(supports);
}

void TissueStructure::lump_mass(const std::vector<ElasticMaterial>& materials) {
  mass_ = Eigen::VectorXd::Zero(mesh_.n_nodes());
  std::array<Eigen::Matrix<double, 8, 1>, 8> shapes;
  const std::array<LocalPoint, 8> points = hex_gauss_points();
  for (int q = 0; q < 8; ++q) shapes[q] = compute_shape(points[q]);
  for (int e = 0; e < mesh_.n_hexahedra(); ++e) {
    const HexNodes nodes = mesh_.gather(e, mesh_.rest_positions);
    const double density = materials[mesh_.material[e]].density;
    for (int q = 0; q < 8; ++q) {
      const double point_mass = density * compute_jacobian(nodes, points[q]).determinant();
      for (int a = 0; a < 8; ++a) mass_[mesh_.hexahedra[e][a]] += point_mass * shapes[q][a];
    }
  }
}

void TissueStructure::find_diagonal(const NodeSupports& supports) {
  dof_mass_.resize(pattern_.n_dofs());
  diagonal_.resize(pattern_.n_dofs());
  for (int a = 0; a < mesh_.n_nodes(); ++a) {
    SprungNode sprung{a, supports.spring[a], {-1, -1, -1}};
    for (int c = 0; c < 3; ++c) {
      const int dof = pattern_.dof_of_component()[3 * a + c];
      if (dof < 0) continue;
      dof_mass_[dof] = mass_[a];
      diagonal_[dof] = sprung.diagonal[c] = pattern_.find(dof, dof);
    }
    if (sprung.stiffness != 0.0) sprung_nodes_.push_back(sprung);
  }
}

}  // namespace lipofill::solid
