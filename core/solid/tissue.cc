#include "core/solid/tissue.h"

#include <limits>
#include <utility>

#include "core/solid/tissue_checks.h"

namespace lipofill::solid {

std::vector<double> youngs_moduli_of(const std::vector<ElasticMaterial>& materials) {
  std::vector<double> moduli;
  for (const ElasticMaterial& material : materials) moduli.push_back(material.youngs_modulus);
  return moduli;
}

absl::StatusOr<Tissue> Tissue::create(HexMesh mesh, const std::vector<ElasticMaterial>& materials,
                                      NodeSupports supports, RayleighDamping damping,
                                      const std::vector<WallSpring>& springs) {
  auto structure = TissueStructure::create(std::move(mesh), materials, std::move(supports), springs);
  if (!structure.ok()) return structure.status();
  return create(*std::move(structure), youngs_moduli_of(materials), damping);
}

absl::StatusOr<Tissue> Tissue::create(std::shared_ptr<const TissueStructure> structure,
                                      const std::vector<double>& youngs_moduli, RayleighDamping damping) {
  if (absl::Status status = check_damping(damping); !status.ok()) return status;
  Tissue tissue(std::move(structure), damping);
  if (absl::Status status = tissue.set_youngs_moduli(youngs_moduli); !status.ok()) return status;
  tissue.assemble(tissue.mesh().rest_positions, std::numeric_limits<double>::infinity());
  return tissue;
}

Tissue::Tissue(std::shared_ptr<const TissueStructure> structure, RayleighDamping damping)
    : structure_(std::move(structure)),
      damping_(damping),
      springs_(structure_->springs().size()),
      positions_(Eigen::Matrix4Xd::Zero(4, mesh().n_nodes())),
      force_(4, mesh().n_nodes()),
      blocks_(structure_->pattern()),
      stiffness_values_(structure_->pattern().n_values()),
      system_matrix_(structure_->pattern().make_matrix()),
      internal_force_(n_dofs()) {
  squeezed_.reserve(mesh().n_hexahedra());
}

absl::Status Tissue::set_youngs_moduli(const std::vector<double>& youngs_moduli) {
  const absl::Status status = check_youngs_moduli(youngs_moduli, structure_->n_materials());
  if (!status.ok()) return status;
  youngs_moduli_ = youngs_moduli;
  batch_moduli_ = structure_->elements().spread_moduli(mesh(), youngs_moduli);
  return absl::OkStatus();
}

void Tissue::assemble(const Eigen::Matrix3Xd& x, double dt) {
  begin(x);
  blocks_.set_zero();
  totals_ = structure_->elements().add(batch_moduli_, positions_, force_, squeezed_, blocks_);
  finish_force();
  compose_system_matrix(dt);
}

void Tissue::compute_force(const Eigen::Matrix3Xd& x) {
  begin(x);
  totals_ = structure_->elements().add_forces(batch_moduli_, positions_, force_, squeezed_);
  finish_force();
}

void Tissue::begin(const Eigen::Matrix3Xd& x) {
  positions_.topRows<3>() = x;
  force_.setZero();
  squeezed_.clear();
}

/// Adds all other forces than those of the hexahedra, and gathers the sum from nodes to degrees of
/// freedom.
void Tissue::finish_force() {
  elastic_energy_ = totals_.elastic_energy;
  elastic_energy_ += structure_->prestress().add_force(positions_, force_);
  for (const int hexahedron : squeezed_) {
    elastic_energy_ += structure_->barrier().add_force(hexahedron, youngs_modulus(hexahedron), positions_, force_);
  }
  elastic_energy_ += structure_->springs().add_force(positions_, springs_, force_);
  add_supports();
  const int* dof = dof_of_component().data();
  double* const to = internal_force_.data();
  for (Eigen::Index node = 0; node < force_.cols(); ++node) {
    for (int c = 0; c < 3; ++c, ++dof) {
      if (*dof >= 0) to[*dof] = force_.data()[4 * node + c];
    }
  }
}

void Tissue::add_supports() {
  for (const TissueStructure::SprungNode& sprung : structure_->sprung_nodes()) {
    for (int c = 0; c < 3; ++c) {
      if (sprung.diagonal[c] < 0) continue;
      const double stretch = positions_(c, sprung.node) - mesh().rest_positions(c, sprung.node);
      force_(c, sprung.node) += sprung.stiffness * stretch;
      elastic_energy_ += 0.5 * sprung.stiffness * stretch * stretch;
    }
  }
}

void Tissue::compose_system_matrix(double dt) {
  TangentValues values{stiffness_values_.data(), system_matrix_.valuePtr(), 1.0 + damping_.beta / dt};
  const SystemPattern& pattern = structure_->pattern();
  blocks_.write(pattern, structure_->prestress().stiffness(), values.factor, values.stiffness, values.system);
  for (const int hexahedron : squeezed_) {
    structure_->barrier().add_tangent(hexahedron, youngs_modulus(hexahedron), positions_, pattern, values);
  }
  structure_->springs().add_tangent(positions_, springs_, values);
  for (const TissueStructure::SprungNode& sprung : structure_->sprung_nodes()) {
    for (const int place : sprung.diagonal) {
      if (place >= 0) values.add_stiffness(place, sprung.stiffness);
    }
  }
  const double mass_factor = 1.0 / (dt * dt) + damping_.alpha / dt;
  const double* mass = structure_->dof_mass().data();
  for (const int place : structure_->diagonal()) values.add_geometric(place, mass_factor * *mass++);
}

void Tissue::stiffness_times(const Eigen::VectorXd& v, Eigen::VectorXd& product) const {
  product.setZero(n_dofs());
  const int* start = system_matrix_.outerIndexPtr();
  const int* row = system_matrix_.innerIndexPtr();
  const double* value = stiffness_values_.data();
  for (int column = 0; column < n_dofs(); ++column) {
    const int last = start[column + 1];
    product[column] += value[start[column]] * v[column];
    for (int k = start[column] + 1; k < last; ++k) {
      product[row[k]] += value[k] * v[column];
      product[column] += value[k] * v[row[k]];
    }
  }
}

Eigen::VectorXd Tissue::stiffness_times(const Eigen::VectorXd& v) const {
  Eigen::VectorXd product;
  stiffness_times(v, product);
  return product;
}

}  // namespace lipofill::solid
