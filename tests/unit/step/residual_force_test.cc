// The forces of a step that are out of balance, against what Newton's law says of them.

#include "core/step/residual_force.h"

#include "tests/unit/mechanics/small_system.h"

namespace lipofill::step {
namespace {

using mechanics::SmallSystem;

/// Sum of a force over the free nodes [N].
Eigen::Vector3d total(const mechanics::TissueSystem& system, const Eigen::VectorXd& force) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const std::vector<int>& dofs = system.tissue().dof_of_component();
  for (size_t k = 0; k < dofs.size(); ++k) {
    if (dofs[k] >= 0) sum[static_cast<Eigen::Index>(k % 3)] += force[dofs[k]];
  }
  return sum;
}

double free_mass(const mechanics::TissueSystem& system) {
  double mass = 0.0;
  const std::vector<int>& dofs = system.tissue().dof_of_component();
  for (size_t k = 0; k < dofs.size(); k += 3) {
    if (dofs[k] >= 0) mass += system.tissue().mass()[static_cast<Eigen::Index>(k / 3)];
  }
  return mass;
}

TEST(ResidualForce, AtRestIsTheWeight) {
  SmallSystem c;
  const Eigen::Vector3d gravity(0.3, -0.2, -9.81);
  ResidualForce forces(*c.system, gravity);
  const auto state = c.state_at(c.system->rest_positions());
  c.system->bring_forces_to(state.positions, c.springs, 0.01);
  Eigen::VectorXd force;
  forces.compute(state, state.positions, 0.01, force);
  EXPECT_LT((total(*c.system, force) - free_mass(*c.system) * gravity).norm(), 1e-9 * free_mass(*c.system));
}

TEST(ResidualForce, ABodyThatKeepsItsVelocityHasNoInertia) {
  SmallSystem c;
  constexpr double kStep = 0.01;
  const double alpha = c.system->tissue().damping().alpha;
  ResidualForce forces(*c.system, Eigen::Vector3d::Zero());
  auto state = c.state_at(c.system->rest_positions());
  const Eigen::Vector3d velocity(1e-3, 2e-3, -1e-3);
  state.velocities.colwise() = velocity;
  const Eigen::Matrix3Xd x = state.positions + kStep * state.velocities;
  c.system->bring_forces_to(state.positions, c.springs, kStep);
  Eigen::VectorXd force;
  forces.compute(state, x, kStep, force);
  // What is left is the damping of the mass alone, as forces are still those at rest.
  const double mass = free_mass(*c.system);
  EXPECT_LT((total(*c.system, force) + alpha * mass * velocity).norm(), 1e-9 * mass * velocity.norm() / kStep);
}

TEST(ResidualForce, TheErrorIsOneWithoutTheFilmsAndNoneInBalance) {
  SmallSystem c;
  ResidualForce forces(*c.system, Eigen::Vector3d::Zero());
  c.system->bring_forces_to(c.system->rest_positions(), c.springs, 0.01);
  c.system->evaluate_gaps(c.system->rest_positions());
  const Eigen::VectorXd pressure = Eigen::VectorXd::Constant(c.system->gaps().volume().size(), 1000.0);
  const Eigen::VectorXd of_films = c.system->gaps().derivative().transpose() * pressure;
  EXPECT_LT(forces.relative_error(-of_films, pressure), 1e-12);
  EXPECT_NEAR(forces.relative_error(Eigen::VectorXd::Zero(of_films.size()), pressure), 1.0, 1e-4);
}

TEST(ResidualForce, CouplingIsWhatTheEarlierDerivativeLeavesOut) {
  SmallSystem c;
  ResidualForce forces(*c.system, Eigen::Vector3d::Zero());
  c.system->evaluate_gaps(c.system->rest_positions());
  const Eigen::SparseMatrix<double> earlier = c.system->gaps().derivative();
  c.system->evaluate_gaps(c.bent(1e-3));
  const Eigen::VectorXd pressure = Eigen::VectorXd::LinSpaced(earlier.rows(), 100.0, 200.0);
  const Eigen::VectorXd expected = (c.system->gaps().derivative() - earlier).transpose() * pressure;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(expected.size());
  forces.add_coupling(earlier, pressure, force);
  EXPECT_LT((force - expected).norm(), 1e-12 * (earlier.transpose() * pressure).norm());
  EXPECT_GT(expected.norm(), 0.0);
}

}  // namespace
}  // namespace lipofill::step
