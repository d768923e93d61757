#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/coupling/gap_system.h"
#include "core/mechanics/film_cells.h"
#include "core/mechanics/simulation_state.h"
#include "core/mechanics/step_cost.h"
#include "core/mechanics/tissue_setup.h"

namespace lipofill::mechanics {

/// The tissue and the gaps of the films on it, as functions of the nodes' positions x and of the
/// springs that are intact: forces f_int(x), stiffness K(x), gap volumes g(x) and their derivative
/// B = dg/dx. Inertia and damping are terms of whoever moves the tissue. It computes what it is
/// asked for again only where positions or springs have changed.
/// Checked by tests/unit/mechanics/tissue_system_test.cc.
class TissueSystem {
 public:
  /// For a model with layers. Field violations of the plan's ligaments, or of a zone that no free
  /// node can open.
  /// @param cost  takes the time of the elements; outlives the system
  static absl::StatusOr<std::unique_ptr<TissueSystem>> create(const model::FaceModel& model,
                                                              const std::vector<plan::FilmLayout>& films,
                                                              const FilmCells& cells, const plan::SimulationSpec& spec,
                                                              StepCost& cost);

  /// Brings forces to positions [m] (3, n_nodes) and springs (1: intact, 0: broken); the stiffness
  /// as well where the damping asks for it, for steps of `dt` [s].
  void bring_forces_to(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& springs, double dt);
  /// Brings forces, S = M/dt^2 + D/dt + K and the gaps with their derivative there.
  void assemble(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& springs, double dt);
  /// Multiplies Young's modulus of each layer of the model by a factor (n_layers); forces and
  /// stiffness have it when they are next brought somewhere. INVALID_ARGUMENT, and nothing
  /// changes, where that takes a modulus out of its bounds.
  absl::Status scale_moduli(const Eigen::VectorXd& factors);
  /// The factors that are in force.
  const Eigen::VectorXd& moduli() const { return moduli_; }
  int n_layers() const { return static_cast<int>(setup_.youngs_moduli.size()); }

  /// Brings the gaps' volumes and their derivative to positions.
  void evaluate_gaps(const Eigen::Matrix3Xd& x) { gaps_->evaluate(x); }

  const solid::Tissue& tissue() const { return setup_.tissue; }
  const TissueSetup& setup() const { return setup_; }
  const coupling::GapSystem& gaps() const { return *gaps_; }
  /// Says what each film's gap is made from, for what simulations of a model share.
  const std::vector<std::string>& gap_keys() const { return gap_keys_; }
  const Eigen::Matrix3Xd& rest_positions() const { return setup_.tissue.mesh().rest_positions; }
  int n_ligament_springs() const;
  /// Sets what a state says of the tissue to its rest.
  void set_rest(SimulationState& state) const;
  /// A force that is round-off beside those that hold the tissue together [N].
  double least_force() const { return least_force_; }

  /// x += dx, dx a value a degree of freedom.
  void add_displacement(const Eigen::VectorXd& dx, Eigen::Matrix3Xd& x) const;

 private:
  TissueSystem(TissueSetup setup, StepCost& cost)
      : setup_(std::move(setup)),
        cost_(cost),
        moduli_(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(setup_.youngs_moduli.size()))) {}
  absl::Status set_up_gaps(const model::FaceModel& model, const std::vector<plan::FilmLayout>& films);
  absl::Status check_every_cell_can_open(const std::vector<plan::FilmLayout>& films, const FilmCells& cells);
  void set_springs(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& springs);

  TissueSetup setup_;
  StepCost& cost_;
  Eigen::VectorXd moduli_;  ///< over those of the setup
  std::unique_ptr<coupling::GapSystem> gaps_;
  std::vector<std::string> gap_keys_;
  double least_force_ = 0.0;
  Eigen::Matrix3Xd forces_positions_;  ///< where the forces are
  Eigen::VectorXd forces_springs_;
};

/// True when two arrays have the same shape and values.
template <typename Matrix>
bool is_same(const Matrix& a, const Matrix& b) {
  return a.cols() == b.cols() && a.rows() == b.rows() && a == b;
}

}  // namespace lipofill::mechanics
