#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/mechanics/tissue_system.h"

namespace lipofill::step {

/// The forces of an implicit Euler step that are out of balance, a value a degree of freedom [N].
/// Internal forces are those that the system was last brought to.
/// Checked by tests/unit/step/residual_force_test.cc.
class ResidualForce {
 public:
  ResidualForce(const mechanics::TissueSystem& system, const Eigen::Vector3d& gravity)
      : system_(system), gravity_(gravity) {}

  /// f = M g - f_int - M (x - x_n - dt v_n)/dt^2 - D (x - x_n)/dt,   D = alpha M + beta K
  ///
  /// @param from  x_n and v_n
  /// @param x     positions [m] (3, n_nodes)
  void compute(const mechanics::SimulationState& from, const Eigen::Matrix3Xd& x, double dt, Eigen::VectorXd& force);
  /// f += (B - B0)^T p, which a factor with the derivative B0 of earlier positions does not know
  /// of.
  void add_coupling(const Eigen::SparseMatrix<double>& earlier_derivative, const Eigen::VectorXd& pressure,
                    Eigen::VectorXd& force);
  /// |f + B^T p| over the forces in balance.
  double relative_error(const Eigen::VectorXd& force, const Eigen::VectorXd& pressure);

 private:
  const mechanics::TissueSystem& system_;
  Eigen::Vector3d gravity_;
  Eigen::VectorXd moved_;     ///< since the start of the step, of the degrees of freedom
  Eigen::VectorXd of_films_;  ///< force of the films
};

}  // namespace lipofill::step
