#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>

#include "absl/status/statusor.h"
#include "core/coupling/gap_system.h"
#include "core/film/film_projection.h"
#include "core/mechanics/tissue_setup.h"
#include "core/plan/film_layout.h"
#include "core/simulation/simulation.h"
#include "tests/bench/jaw_angle.h"

namespace lipofill::bench {

/// What a linear step is solved for.
struct LinearAnswer {
  Eigen::VectorXd displacement;  ///< dx [m] (n_dofs)
  Eigen::VectorXd pressure;      ///< p [Pa] (n_cells)
};

/// The linear system of one step, from the matrices of a run:
///
///     S dx - B^T p = f,      B dx + J p = d
struct LinearStep {
  Eigen::SparseMatrix<double> s;  ///< lower triangle (n_dofs, n_dofs) [N/m]
  Eigen::SparseMatrix<double> b;  ///< (n_cells, n_dofs) [m2]
  Eigen::SparseMatrix<double> j;  ///< dt J, both triangles (n_cells, n_cells) [m3/Pa]
  Eigen::VectorXd f;              ///< [N]
  Eigen::VectorXd d;              ///< [m3]

  int n_dofs() const { return static_cast<int>(s.cols()); }
  int n_cells() const { return static_cast<int>(b.rows()); }
};

/// Tissue and film of a case, brought to where a simulation of it is, by the model's own parts.
class StepParts {
 public:
  static absl::StatusOr<std::unique_ptr<StepParts>> create(const JawAngle& jaw);

  /// Takes positions, thickness and pressure of the simulation's frame.
  void move_to(const simulation::Simulation& simulation);
  /// The tissue waved by a millimetre over a film of half a millimetre or more: work like that of a
  /// run, at no cost.
  void move_to_wave();

  /// The element work of a step: forces, stiffness and gap where move_to() has put the tissue, for
  /// steps of the plan.
  void assemble();

  /// The step that follows from there, from rest.
  LinearStep linear_step();

  solid::Tissue& tissue() { return tissue_->tissue; }
  coupling::GapSystem& gaps() { return *gaps_; }
  /// In the midst of the step that linear_step() is of.
  film::FilmProjection& projection() { return *projection_; }
  const film::FilmMetric& metric() const { return metric_; }
  const Eigen::Matrix3Xd& positions() const { return positions_; }
  const Eigen::VectorXd& thickness() const { return thickness_; }
  const Eigen::VectorXd& pressure() const { return pressure_; }

 private:
  explicit StepParts(const JawAngle& jaw) : jaw_(jaw) {}
  void begin_film_step();

  const JawAngle& jaw_;
  std::vector<plan::FilmLayout> films_;
  std::unique_ptr<mechanics::TissueSetup> tissue_;
  std::unique_ptr<coupling::GapSystem> gaps_;
  std::unique_ptr<film::FilmProjection> projection_;
  film::FilmMetric rest_metric_;
  film::FilmMetric metric_;  ///< where the tissue is
  Eigen::Matrix3Xd positions_;
  Eigen::VectorXd thickness_;  ///< [m] (n_cells)
  Eigen::VectorXd pressure_;   ///< [Pa] (n_cells)
};

/// How far two answers are apart, relative to the second: the larger of pressure's and
/// displacement's, in the 2-norm.
double relative_difference(const LinearAnswer& answer, const LinearAnswer& reference);

}  // namespace lipofill::bench
