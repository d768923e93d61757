#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/solid/geometric_stiffness.h"
#include "core/solid/hex_mesh.h"
#include "core/solid/inversion_barrier.h"
#include "core/solid/material.h"
#include "core/solid/prestress.h"
#include "core/solid/system_pattern.h"
#include "core/solid/wall_springs.h"

namespace lipofill::solid {

class ElementAssembler;
struct ElementTotals;

/// How the nodes are held. Nodes may be in several entries; fixed wins over springs.
struct NodeSupports {
  std::vector<std::array<bool, 3>> fixed;  ///< a triple a node: x, y, z held at rest; empty: none held
  std::vector<double> spring;              ///< isotropic spring to the rest position, a value a node [N/m]; empty: none
};

/// Rayleigh damping D = alpha M + beta K.
struct RayleighDamping {
  double alpha = 0.0;  ///< [1/s]
  double beta = 0.0;   ///< [s]
};

/// Corotational finite-element tissue:
///
///     f_int(x) = sum_e R_e K_e (R_e^T x_e - X_e) + springs + prestress + barrier
///                                                       R_e: rotation of the element's centre, K_e constant (24, 24)
///     S        = M/dt^2 + D/dt + K + K_G,   K = sum_e R_e K_e R_e^T + springs
///
/// with K_G the stiffness of tension: of what strain brings (geometric_stiffness.h), of what is there at rest
/// (prestress.h), of springs across films (wall_springs.h) and of what is squeezed flat (inversion_barrier.h);
/// after Mueller & Gross (2004); S is the paper's K of eq. 5. Mass is lumped by row sums, so that gravity on it is the
/// consistent load. K_e is the solid-shell (solid_shell.h), in stacked layers EAS-9 (incompatible_modes.h). Degrees of
/// freedom are the components of nodes that are not fixed, numbered node by node.
///
/// Deterministic: everything depends on the last assemble alone, summed in the order of the mesh.
/// Checked by tests/unit/solid/ and tests/verification/solid/ (patch test, rigid rotation, clamped plate and others).
class Tissue {
 public:
  /// INVALID_ARGUMENT with a violation each for sizes that disagree, a node index out of range or a node in no
  /// hexahedron, a position that is not finite, a material, spring or damping out of bounds, a hexahedron with a
  /// non-positive Jacobian at a corner or Gauss point, naming it.
  static absl::StatusOr<Tissue> create(HexMesh mesh, std::vector<ElasticMaterial> materials, NodeSupports supports,
                                       RayleighDamping damping, std::vector<WallSpring> springs = {});

  Tissue(Tissue&& other) noexcept;
  Tissue& operator=(Tissue&& other) noexcept;
  ~Tissue();

  const HexMesh& mesh() const { return mesh_; }
  int n_dofs() const { return pattern_.n_dofs(); }
  /// Degree of freedom of component c of node a at 3 a + c; -1 where fixed.
  const std::vector<int>& dof_of_component() const { return pattern_.dof_of_component(); }
  /// Lumped mass, a value a node [kg].
  const Eigen::VectorXd& mass() const { return mass_; }

  /// Brings rotations, internal force and stiffness to the positions `x` (3, n_nodes) [m]. `dt` > 0 [s]; infinity gives
  /// S = K + K_G. Fixed components of `x` count where they are, so a support may be moved. Allocates nothing.
  void assemble(const Eigen::Matrix3Xd& x, double dt);

  /// Brings internal force, energy, volume ratio and springs to the positions `x`, the same bits as assemble, at less
  /// than half its cost; stiffness and system matrix stay those of the last assemble. Allocates nothing.
  void compute_force(const Eigen::Matrix3Xd& x);

  int n_springs() const { return springs_.size(); }
  /// A broken spring carries nothing from the next assemble on. All are intact at first.
  void set_spring_intact(int spring, bool intact) { springs_.set_intact(spring, intact); }
  bool spring_intact(int spring) const { return springs_.intact(spring); }
  /// Of a spring at the last assemble: tension [N], 0 when slack or broken, and distance between its ends [m].
  double spring_tension(int spring) const { return springs_.tension(spring); }
  double spring_length(int spring) const { return springs_.length(spring); }

  /// f_int of the last assemble or compute_force, springs included, a value a degree of freedom [N].
  const Eigen::VectorXd& internal_force() const { return internal_force_; }

  /// K of the last assemble times a vector of degrees of freedom [N]; for damping forces.
  Eigen::VectorXd stiffness_times(const Eigen::VectorXd& v) const;

  /// S of the last assemble: its lower triangle, in a pattern that never changes (columns ascending, rows ascending in
  /// each).
  const Eigen::SparseMatrix<double>& system_matrix() const { return system_matrix_; }

  /// Elastic energy of the last assemble, 1/2 sum_e d_e^T K_e d_e + springs + prestress + barrier  [J]. Springs,
  /// prestress and barrier are its exact slope in internal_force(); the elements' part is off by a share of the strain,
  /// since the force leaves out how the rotations turn: 0.1 % in a distorted plate bent by 2 %
  /// (tests/unit/solid/tissue_energy_test.cc).
  double elastic_energy() const { return elastic_energy_; }

  /// Smallest det(F) over element centres at the last assemble; not positive: the element is turned inside out. Minus
  /// infinity where positions are not finite.
  double min_volume_ratio() const { return min_volume_ratio_; }

  const RayleighDamping& damping() const { return damping_; }

 private:
  Tissue(HexMesh mesh, const std::vector<ElasticMaterial>& materials, NodeSupports supports, RayleighDamping damping,
         const std::vector<WallSpring>& springs);
  void lump_mass(const std::vector<ElasticMaterial>& materials);
  void prepare_diagonal();
  void add_all_but_elements(const Eigen::Matrix3Xd& x, const ElementTotals& of_elements, Eigen::VectorXd& stiffness,
                            Eigen::VectorXd& geometric);
  void add_supports(const Eigen::Matrix3Xd& x, Eigen::VectorXd& stiffness_values);
  void compose_system_matrix(double dt);

  HexMesh mesh_;
  NodeSupports supports_;
  RayleighDamping damping_;
  SystemPattern pattern_;
  std::unique_ptr<const ElementAssembler> elements_;
  Eigen::VectorXd mass_;
  Eigen::VectorXd dof_mass_;   ///< mass of the node of each degree of freedom [kg]
  std::vector<int> diagonal_;  ///< where the diagonal value of each degree of freedom is
  GeometricStiffness geometric_stiffness_;
  Prestress prestress_;
  InversionBarrier barrier_;
  WallSprings springs_;
  Eigen::VectorXd geometric_values_;  ///< K_G in the pattern [N/m]
  Eigen::VectorXd stiffness_values_;  ///< K in the pattern, then one place for what is not kept [N/m]
  Eigen::VectorXd ignored_values_;    ///< where compute_force lets stiffness go
  Eigen::VectorXd padded_force_;      ///< f_int, then one place for what is not kept [N]
  Eigen::VectorXd internal_force_;
  Eigen::SparseMatrix<double> system_matrix_;
  double elastic_energy_ = 0.0;
  double min_volume_ratio_ = 1.0;
};

}  // namespace lipofill::solid
