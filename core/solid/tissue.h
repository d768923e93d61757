#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/solid/hex_mesh.h"
#include "core/solid/material.h"
#include "core/solid/node_blocks.h"
#include "core/solid/tissue_structure.h"
#include "core/solid/wall_springs.h"

namespace lipofill::solid {

/// Rayleigh damping D = alpha M + beta K.
struct RayleighDamping {
  double alpha = 0.0;  ///< [1/s]
  double beta = 0.0;   ///< [s]
};

/// Young's modulus of each material [Pa].
std::vector<double> youngs_moduli_of(const std::vector<ElasticMaterial>& materials);

/// Finite-element tissue, each material corotational or neo-Hookean:
///
///     f_int(x) = sum_e R_e K_e (R_e^T x_e - X_e) + springs + prestress + barrier
///                        R_e: rotation of the element's centre, K_e = E_e times a constant (24, 24)
///     S        = M/dt^2 + D/dt + K + K_G,   K = sum_e R_e K_e R_e^T + springs
///
/// with K_G the stiffness of tension: of what strain brings (geometric_stiffness.h), of what is
/// there at rest (prestress.h), of springs across films (wall_springs.h) and of what is squeezed
/// flat (inversion_barrier.h); after Mueller & Gross (2004); S is the paper's K of eq. 5. Mass is
/// lumped by row sums, so that gravity on it is the consistent load. K_e is the solid-shell
/// (solid_shell.h), in stacked layers EAS-9 (incompatible_modes.h). Hexahedra of neo-Hookean
/// materials have dW/dx and its tangent in place of these terms (neo_hookean_batch.h). Degrees of
/// freedom are the components of nodes that are not fixed, numbered node by node.
///
/// The parts that never change are in a TissueStructure, which tissues share; a tissue itself holds
/// values and Young's moduli. Deterministic: everything depends on the moduli and the last assemble
/// alone, summed in an order that the mesh decides. Checked by tests/unit/solid/ and
/// tests/verification/solid/ (patch test, rigid rotation, clamped plate and others).
class Tissue {
 public:
  /// Creates a tissue. INVALID_ARGUMENT as TissueStructure::create, and for damping out of bounds.
  static absl::StatusOr<Tissue> create(HexMesh mesh, const std::vector<ElasticMaterial>& materials,
                                       NodeSupports supports, RayleighDamping damping,
                                       const std::vector<WallSpring>& springs = {});
  /// @param youngs_moduli  E [Pa], a value a material of the structure
  static absl::StatusOr<Tissue> create(std::shared_ptr<const TissueStructure> structure,
                                       const std::vector<double>& youngs_moduli, RayleighDamping damping);

  const std::shared_ptr<const TissueStructure>& structure() const { return structure_; }
  const HexMesh& mesh() const { return structure_->mesh(); }
  int n_dofs() const { return structure_->pattern().n_dofs(); }
  /// Degree of freedom of component c of node a at 3 a + c; -1 where fixed.
  const std::vector<int>& dof_of_component() const { return structure_->pattern().dof_of_component(); }
  /// Lumped mass, a value a node [kg].
  const Eigen::VectorXd& mass() const { return structure_->mass(); }

  /// Sets Young's moduli [Pa], a value a material; forces and stiffness have them from the next
  /// assemble or compute_force on, and are then the same bits as in a tissue created with them.
  /// INVALID_ARGUMENT, and nothing changes, where one is out of bounds or their number is wrong.
  absl::Status set_youngs_moduli(const std::vector<double>& youngs_moduli);

  /// Brings rotations, internal force and stiffness to the positions `x` (3, n_nodes) [m]. `dt` > 0
  /// [s]; infinity gives S = K + K_G. Fixed components of `x` count where they are, so a support
  /// may be moved. Allocates nothing.
  void assemble(const Eigen::Matrix3Xd& x, double dt);

  /// Brings internal force, energy, volume ratio and springs to the positions `x`, the same bits as
  /// assemble, at a quarter of its cost; stiffness and system matrix stay those of the last
  /// assemble. Allocates nothing.
  void compute_force(const Eigen::Matrix3Xd& x);

  int n_springs() const { return static_cast<int>(springs_.size()); }
  /// A broken spring carries nothing from the next assemble on. All are intact at first.
  void set_spring_intact(int spring, bool intact) { springs_[spring].intact = intact; }
  /// Tension of a spring [N], 0 when slack or broken, and the distance between its ends [m], both
  /// at the last assemble.
  double spring_tension(int spring) const { return springs_[spring].tension; }
  double spring_length(int spring) const { return springs_[spring].length; }

  /// f_int of the last assemble or compute_force, springs included, a value a degree of freedom
  /// [N].
  const Eigen::VectorXd& internal_force() const { return internal_force_; }

  /// K of the last assemble times a vector of degrees of freedom [N]; for damping forces.
  void stiffness_times(const Eigen::VectorXd& v, Eigen::VectorXd& product) const;
  Eigen::VectorXd stiffness_times(const Eigen::VectorXd& v) const;

  /// S of the last assemble: its lower triangle, in a pattern that never changes (columns
  /// ascending, rows ascending in each).
  const Eigen::SparseMatrix<double>& system_matrix() const { return system_matrix_; }

  /// Elastic energy of the last assemble, 1/2 sum_e d_e^T K_e d_e + springs + prestress + barrier  [J]. Springs,
  /// prestress, barrier and neo-Hookean hexahedra are its exact slope in internal_force(); the part
  /// of corotational ones is off by a share of the strain, since the force leaves out how the
  /// rotations turn: 0.1 % in a distorted plate bent by 2 %
  /// (tests/unit/solid/tissue_energy_test.cc).
  double elastic_energy() const { return elastic_energy_; }

  /// Smallest det(F) over element centres at the last assemble; not positive: the element is turned
  /// inside out. Minus infinity where positions are not finite.
  double min_volume_ratio() const { return totals_.min_volume_ratio; }

  /// True when the scaled Jacobian (hex_quality.h) of a hexahedron was not positive at the last
  /// assemble or compute_force, which find it on their way.
  bool is_folded() const { return totals_.is_folded; }

  const RayleighDamping& damping() const { return damping_; }

 private:
  Tissue(std::shared_ptr<const TissueStructure> structure, RayleighDamping damping);
  void begin(const Eigen::Matrix3Xd& x);
  void finish_force();
  void add_supports();
  void compose_system_matrix(double dt);
  double youngs_modulus(int hexahedron) const { return youngs_moduli_[mesh().material[hexahedron]]; }

  std::shared_ptr<const TissueStructure> structure_;
  RayleighDamping damping_;
  std::vector<double> youngs_moduli_;       ///< of each material [Pa]
  std::vector<double> batch_moduli_;        ///< of each hexahedron, in the order of the batches [Pa]
  std::vector<double> neo_hookean_moduli_;  ///< the same of neo-Hookean hexahedra
  std::vector<WallSpringState> springs_;
  Eigen::Matrix4Xd positions_;        ///< of the last assemble or compute_force; the last row is 0
  Eigen::Matrix4Xd force_;            ///< f_int, a column a node; the last row has no meaning [N]
  std::vector<int> squeezed_;         ///< hexahedra that the barrier may act on
  ElementTotals totals_;              ///< of the hexahedra
  NodeBlocks blocks_;                 ///< K and K_G of the hexahedra [N/m]
  Eigen::VectorXd stiffness_values_;  ///< K in the pattern [N/m]
  Eigen::SparseMatrix<double> system_matrix_;
  Eigen::VectorXd internal_force_;
  double elastic_energy_ = 0.0;
};

}  // namespace lipofill::solid
