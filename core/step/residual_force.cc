#include "core/step/residual_force.h"

namespace lipofill::step {

void ResidualForce::compute(const mechanics::SimulationState& from, const Eigen::Matrix3Xd& x, double dt,
                            Eigen::VectorXd& force) {
  const solid::Tissue& tissue = system_.tissue();
  const double alpha = tissue.damping().alpha;
  const double beta = tissue.damping().beta;
  const std::vector<int>& dofs = tissue.dof_of_component();
  force = -tissue.internal_force();
  moved_.resize(tissue.n_dofs());
  for (size_t k = 0; k < dofs.size(); ++k) {
    if (dofs[k] < 0) continue;
    const auto node = static_cast<Eigen::Index>(k / 3);
    const auto c = static_cast<Eigen::Index>(k % 3);
    const double mass = tissue.mass()[node];
    const double step = x(c, node) - from.positions(c, node);
    moved_[dofs[k]] = step;
    force[dofs[k]] += mass * (gravity_[c] - (step - dt * from.velocities(c, node)) / (dt * dt) - alpha * step / dt);
  }
  if (beta > 0.0) force -= (beta / dt) * tissue.stiffness_times(moved_);
}

void ResidualForce::add_coupling(const Eigen::SparseMatrix<double>& earlier_derivative, const Eigen::VectorXd& pressure,
                                 Eigen::VectorXd& force) {
  of_films_.noalias() = system_.gaps().derivative().transpose() * pressure;
  force += of_films_;
  of_films_.noalias() = earlier_derivative.transpose() * pressure;
  force -= of_films_;
}

double ResidualForce::relative_error(const Eigen::VectorXd& force, const Eigen::VectorXd& pressure) {
  of_films_.noalias() = system_.gaps().derivative().transpose() * pressure;
  const double scale = of_films_.norm() + system_.tissue().internal_force().norm() + system_.least_force();
  return (force + of_films_).norm() / scale;
}

}  // namespace lipofill::step
