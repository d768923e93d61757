#include "core/solid/tissue.h"

#include <Eigen/LU>
#include <limits>
#include <utility>

#include "core/solid/element_assembler.h"
#include "core/solid/hex_shape.h"
#include "core/solid/tissue_checks.h"

namespace lipofill::solid {

absl::StatusOr<Tissue> Tissue::create(HexMesh mesh, std::vector<ElasticMaterial> materials, NodeSupports supports,
                                      RayleighDamping damping, std::vector<WallSpring> springs) {
  if (supports.fixed.empty()) supports.fixed.resize(mesh.n_nodes(), {false, false, false});
  if (supports.spring.empty()) supports.spring.resize(mesh.n_nodes(), 0.0);
  absl::Status status = check_tissue(mesh, materials, supports, damping, springs);
  if (!status.ok()) return status;
  Tissue tissue(std::move(mesh), materials, std::move(supports), damping, springs);
  tissue.assemble(tissue.mesh_.rest_positions, std::numeric_limits<double>::infinity());
  return tissue;
}

Tissue::Tissue(HexMesh mesh, const std::vector<ElasticMaterial>& materials, NodeSupports supports,
               RayleighDamping damping, const std::vector<WallSpring>& springs)
    : mesh_(std::move(mesh)),
      supports_(std::move(supports)),
      damping_(damping),
      pattern_(mesh_.n_nodes(), mesh_.hexahedra, supports_.fixed, collect_coupled_nodes(springs)),
      elements_(std::make_unique<const ElementAssembler>(mesh_, materials, pattern_)),
      geometric_stiffness_(mesh_, materials, pattern_),
      prestress_(mesh_, materials, pattern_),
      barrier_(mesh_, materials),
      springs_(springs, mesh_.rest_positions, pattern_),
      geometric_values_(pattern_.matrix().nonZeros()),
      stiffness_values_(pattern_.matrix().nonZeros() + 1),
      ignored_values_(pattern_.matrix().nonZeros() + 1),
      padded_force_(pattern_.n_dofs() + 1),
      internal_force_(pattern_.n_dofs()),
      system_matrix_(pattern_.matrix()) {
  lump_mass(materials);
  prepare_diagonal();
}

Tissue::Tissue(Tissue&& other) noexcept = default;
Tissue& Tissue::operator=(Tissue&& other) noexcept = default;
Tissue::~Tissue() = default;

void Tissue::lump_mass(const std::vector<ElasticMaterial>& materials) {
  mass_ = Eigen::VectorXd::Zero(mesh_.n_nodes());
  for (int e = 0; e < mesh_.n_hexahedra(); ++e) {
    const HexNodes nodes = mesh_.gather(e, mesh_.rest_positions);
    const double density = materials[mesh_.material[e]].density;
    for (const LocalPoint& point : hex_gauss_points()) {
      const double point_mass = density * compute_jacobian(nodes, point).determinant();
      const Eigen::Matrix<double, 8, 1> N = compute_shape(point);
      for (int a = 0; a < 8; ++a) mass_[mesh_.hexahedra[e][a]] += point_mass * N[a];
    }
  }
}

void Tissue::prepare_diagonal() {
  dof_mass_.resize(n_dofs());
  diagonal_.resize(n_dofs());
  for (int component = 0; component < 3 * mesh_.n_nodes(); ++component) {
    const int dof = dof_of_component()[component];
    if (dof < 0) continue;
    dof_mass_[dof] = mass_[component / 3];
    diagonal_[dof] = pattern_.find(dof, dof);
  }
}

void Tissue::assemble(const Eigen::Matrix3Xd& x, double dt) {
  stiffness_values_.setZero();
  geometric_values_.setZero();
  padded_force_.setZero();
  const ElementTotals totals = elements_->add(x, stiffness_values_, padded_force_);
  geometric_stiffness_.add(x, geometric_values_);
  prestress_.add_stiffness(geometric_values_);
  add_all_but_elements(x, totals, stiffness_values_, geometric_values_);
  compose_system_matrix(dt);
}

void Tissue::compute_force(const Eigen::Matrix3Xd& x) {
  ignored_values_.setZero();
  padded_force_.setZero();
  const ElementTotals totals = elements_->add_force(x, padded_force_);
  add_all_but_elements(x, totals, ignored_values_, ignored_values_);
}

void Tissue::add_all_but_elements(const Eigen::Matrix3Xd& x, const ElementTotals& of_elements,
                                  Eigen::VectorXd& stiffness, Eigen::VectorXd& geometric) {
  elastic_energy_ = of_elements.elastic_energy;
  min_volume_ratio_ = of_elements.min_volume_ratio;
  elastic_energy_ += prestress_.add_force(x, padded_force_);
  elastic_energy_ += barrier_.add(x, pattern_, geometric, padded_force_);
  elastic_energy_ += springs_.add(x, stiffness, geometric, padded_force_);
  add_supports(x, stiffness);
  internal_force_ = padded_force_.head(n_dofs());
}

void Tissue::add_supports(const Eigen::Matrix3Xd& x, Eigen::VectorXd& stiffness_values) {
  for (int a = 0; a < mesh_.n_nodes(); ++a) {
    const double stiffness = supports_.spring[a];
    if (stiffness == 0.0) continue;
    for (int c = 0; c < 3; ++c) {
      const int dof = dof_of_component()[3 * a + c];
      if (dof < 0) continue;
      const double stretch = x(c, a) - mesh_.rest_positions(c, a);
      padded_force_[dof] += stiffness * stretch;
      stiffness_values[diagonal_[dof]] += stiffness;
      elastic_energy_ += 0.5 * stiffness * stretch * stretch;
    }
  }
}

void Tissue::compose_system_matrix(double dt) {
  const double stiffness_factor = 1.0 + damping_.beta / dt;
  const double mass_factor = 1.0 / (dt * dt) + damping_.alpha / dt;
  Eigen::Map<Eigen::VectorXd> values(system_matrix_.valuePtr(), system_matrix_.nonZeros());
  values = stiffness_factor * stiffness_values_.head(system_matrix_.nonZeros()) + geometric_values_;
  for (int dof = 0; dof < n_dofs(); ++dof) values[diagonal_[dof]] += mass_factor * dof_mass_[dof];
}

Eigen::VectorXd Tissue::stiffness_times(const Eigen::VectorXd& v) const {
  const Eigen::Map<const Eigen::SparseMatrix<double>> K(n_dofs(), n_dofs(), system_matrix_.nonZeros(),
                                                        system_matrix_.outerIndexPtr(), system_matrix_.innerIndexPtr(),
                                                        stiffness_values_.data());
  return K.selfadjointView<Eigen::Lower>() * v;
}

}  // namespace lipofill::solid
