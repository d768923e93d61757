#include "core/solid/wall_springs.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/solid/tissue.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

constexpr double kStatic = std::numeric_limits<double>::infinity();

/// Two slabs, one above the other with a gap between them, and a third that touches the second:
/// springs across one film, across both, and where walls touch.
struct Sandwich {
  Box box{{2, 2, 1}, {0.02, 0.02, 0.002}};
  HexMesh mesh;
  NodeSupports supports;
  std::vector<WallSpring> springs;

  Sandwich() {
    const HexMesh slab = box.make();
    const int n = box.n_nodes();
    mesh.rest_positions.resize(3, 3 * n);
    const double heights[] = {0.0, 0.0025, 0.0045};
    for (int k = 0; k < 3; ++k) {
      mesh.rest_positions.middleCols(k * n, n) = slab.rest_positions;
      mesh.rest_positions.middleCols(k * n, n).row(2).array() += heights[k];
      for (std::array<int, 8> hexahedron : slab.hexahedra) {
        for (int& node : hexahedron) node += k * n;
        mesh.hexahedra.push_back(hexahedron);
      }
    }
    mesh.material.assign(mesh.hexahedra.size(), 0);
    mesh.stacked.assign(mesh.hexahedra.size(), false);
    supports.fixed.assign(3 * n, {false, false, false});
    for (int a = 0; a < box.node(0, 0, 1); ++a) supports.fixed[a] = {true, true, true};
    springs = {{{top(1, 0), top(1, 1), top(1, 0), top(1, 1)},
                {bottom(0, 0), bottom(0, 1), bottom(0, 2), bottom(1, 0)},
                {0.4, 0.3, 0.2, 0.1},
                50.0},
               point_spring(bottom(2, 4) + 4, bottom(0, 4), 80.0, 1e-4),
               point_spring(bottom(2, 2), top(1, 2), 60.0)};
  }

  /// k-th node of the outer and of the inner face of a slab; `bottom(0, .)` is the outer face of
  /// the lowest.
  int top(int slab, int k) const { return slab * box.n_nodes() + (slab == 0 ? 0 : box.node(0, 0, 1)) + k; }
  int bottom(int slab, int k) const { return slab * box.n_nodes() + (slab == 0 ? box.node(0, 0, 1) : 0) + k; }

  static WallSpring point_spring(int outer, int inner, double stiffness, double slack = 0.0) {
    return {{outer, 0, 0, 0}, {inner, 0, 0, 0}, {1.0, 0.0, 0.0, 0.0}, stiffness, slack};
  }

  Tissue make() const { return Tissue::create(mesh, {{1e4, 0.4, 1000.0}}, supports, {}, springs).value(); }

  /// The slabs pulled apart and shaken.
  Eigen::Matrix3Xd pulled(double apart, double amplitude, unsigned seed) const {
    Jitter jitter(seed);
    Eigen::Matrix3Xd x = mesh.rest_positions;
    for (int a = 0; a < x.cols(); ++a) {
      x.col(a) += amplitude * jitter.next_vector();
      x(2, a) += apart * (a / box.n_nodes());
    }
    return x;
  }
};

/// d of a spring, straight from its definition.
Eigen::Vector3d separation(const WallSpring& spring, const Eigen::Matrix3Xd& x) {
  Eigen::Vector3d d = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4; ++k) d += spring.weight[k] * (x.col(spring.outer[k]) - x.col(spring.inner[k]));
  return d;
}

Eigen::MatrixXd full(const Eigen::SparseMatrix<double>& lower) {
  return Eigen::MatrixXd(Eigen::SparseMatrix<double>(lower.selfadjointView<Eigen::Lower>()));
}

/// Springs alone, on every component: the difference between a tissue with and without them.
struct SpringsAlone {
  double energy;
  Eigen::VectorXd force;
  Eigen::MatrixXd tangent;

  SpringsAlone(const Sandwich& sandwich, const Eigen::Matrix3Xd& x, bool held = false) {
    const NodeSupports supports = held ? sandwich.supports : NodeSupports{};
    const std::vector<ElasticMaterial> materials = {{1e4, 0.4, 1000.0}};
    Tissue with = Tissue::create(sandwich.mesh, materials, supports, {}, sandwich.springs).value();
    Tissue without = Tissue::create(sandwich.mesh, materials, supports, {}).value();
    with.assemble(x, kStatic);
    without.assemble(x, kStatic);
    energy = with.elastic_energy() - without.elastic_energy();
    force = with.internal_force() - without.internal_force();
    tangent = full(with.system_matrix()) - full(without.system_matrix());
  }
};

TEST(WallSprings, PullByStretchBeyondSlack) {
  const Sandwich sandwich;
  Tissue tissue = sandwich.make();
  const Eigen::Matrix3Xd x = sandwich.pulled(1e-3, 2e-4, 1);
  tissue.assemble(x, kStatic);
  double energy = 0.0;
  for (int s = 0; s < tissue.n_springs(); ++s) {
    const WallSpring& spring = sandwich.springs[s];
    const double length = separation(spring, x).norm();
    const double rest = separation(spring, sandwich.mesh.rest_positions).norm();
    const double tension = spring.stiffness * (length - rest - spring.slack);
    ASSERT_GT(tension, 0.0);
    EXPECT_NEAR(tissue.spring_length(s), length, 1e-15);
    EXPECT_NEAR(tissue.spring_tension(s), tension, 1e-13);
    energy += 0.5 * tension * tension / spring.stiffness;
  }
  EXPECT_NEAR(SpringsAlone(sandwich, x).energy, energy, 1e-9 * energy);
}

/// Force against differences of the energy, tangent against differences of the force.
TEST(WallSprings, AreDerivativesOfTheirEnergy) {
  const Sandwich sandwich;
  const Eigen::Matrix3Xd x = sandwich.pulled(1e-3, 2e-4, 2);
  const SpringsAlone at(sandwich, x);
  Eigen::Matrix3Xd direction(3, x.cols());
  Jitter jitter(3);
  for (int a = 0; a < x.cols(); ++a) direction.col(a) = jitter.next_vector();
  const Eigen::Map<const Eigen::VectorXd> v(direction.data(), direction.size());
  const double h = 1e-7;
  const SpringsAlone forward(sandwich, x + h * direction);
  const SpringsAlone backward(sandwich, x - h * direction);
  EXPECT_NEAR((forward.energy - backward.energy) / (2.0 * h), at.force.dot(v), 1e-5 * at.force.norm() * v.norm());
  const Eigen::VectorXd difference = (forward.force - backward.force) / (2.0 * h);
  EXPECT_LT((difference - at.tangent * v).norm(), 1e-5 * difference.norm());
}

TEST(WallSprings, ActAndReact) {
  const Sandwich sandwich;
  const Eigen::Matrix3Xd x = sandwich.pulled(1e-3, 2e-4, 4);
  const SpringsAlone springs(sandwich, x);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (int a = 0; a < x.cols(); ++a) force += springs.force.segment<3>(3 * a);
  EXPECT_LT(force.norm(), 1e-12 * springs.force.norm());
  for (const WallSpring& spring : sandwich.springs) {
    EXPECT_GT(springs.force.segment<3>(3 * spring.outer[0]).dot(separation(spring, x)), 0.0);
    EXPECT_LT(springs.force.segment<3>(3 * spring.inner[0]).dot(separation(spring, x)), 0.0);
  }
}

/// Turned and moved as a whole, a pulled sandwich feels the same.
TEST(WallSprings, TurnWithTheirPoints) {
  const Sandwich sandwich;
  const Eigen::Matrix3Xd x = sandwich.pulled(1e-3, 2e-4, 5);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  const SpringsAlone before(sandwich, x);
  const SpringsAlone after(sandwich, (R * x).colwise() + Eigen::Vector3d(0.3, -0.1, 0.2));
  EXPECT_NEAR(after.energy, before.energy, 1e-9 * before.energy);
  for (int a = 0; a < x.cols(); ++a) {
    EXPECT_LT((after.force.segment<3>(3 * a) - R * before.force.segment<3>(3 * a)).norm(), 1e-9 * before.force.norm());
  }
}

TEST(WallSprings, TangentMatchesDenseAssemblyAcrossLayers) {
  const Sandwich sandwich;
  const Eigen::Matrix3Xd x = sandwich.pulled(8e-4, 1e-4, 6);
  const Tissue tissue = sandwich.make();
  const Eigen::Index n = x.size();
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(n, n);
  for (const WallSpring& spring : sandwich.springs) {
    const Eigen::Vector3d d = separation(spring, x);
    const double taut = separation(spring, sandwich.mesh.rest_positions).norm() + spring.slack;
    const Eigen::Matrix3d along = d * d.transpose() / d.squaredNorm();
    const Eigen::Matrix3d block =
        spring.stiffness * (along + (1.0 - taut / d.norm()) * (Eigen::Matrix3d::Identity() - along));
    Eigen::Matrix3Xd B = Eigen::Matrix3Xd::Zero(3, n);
    for (int k = 0; k < 4; ++k) {
      B.middleCols<3>(3 * spring.outer[k]) += spring.weight[k] * Eigen::Matrix3d::Identity();
      B.middleCols<3>(3 * spring.inner[k]) -= spring.weight[k] * Eigen::Matrix3d::Identity();
    }
    expected += B.transpose() * block * B;
  }
  const SpringsAlone springs(sandwich, x, true);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const int row = tissue.dof_of_component()[i];
      const int column = tissue.dof_of_component()[j];
      if (row < 0 || column < 0) continue;
      EXPECT_NEAR(springs.tangent(row, column), expected(i, j), 1e-10);
    }
  }
}

/// Without springs the two upper slabs would float.
TEST(WallSprings, HoldWhatWouldFloat) {
  Sandwich sandwich;
  for (int k = 0; k < 9; ++k) {
    sandwich.springs.push_back(Sandwich::point_spring(sandwich.bottom(1, k), sandwich.bottom(0, k), 20.0));
    sandwich.springs.push_back(Sandwich::point_spring(sandwich.bottom(2, k), sandwich.top(1, k), 20.0));
  }
  Tissue tissue = sandwich.make();
  for (const double amplitude : {1e-5, 3e-4}) {
    tissue.assemble(sandwich.pulled(1e-3, amplitude, 7), kStatic);
    EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(full(tissue.system_matrix())).info(), Eigen::Success);
  }
}

TEST(WallSprings, SlackOnesCarryNothing) {
  Sandwich sandwich;
  for (WallSpring& spring : sandwich.springs) spring.slack = 2e-3;
  const SpringsAlone slack(sandwich, sandwich.pulled(5e-4, 1e-4, 8));
  EXPECT_EQ(slack.force.norm(), 0.0);
  EXPECT_EQ(slack.tangent.norm(), 0.0);
  EXPECT_EQ(slack.energy, 0.0);
  EXPECT_GT(SpringsAlone(sandwich, sandwich.pulled(3e-3, 1e-4, 8)).force.norm(), 0.0);
}

/// Pushed together they do not push back.
TEST(WallSprings, NeverPush) {
  Sandwich sandwich;
  sandwich.springs.resize(2);  // those with a length at rest
  const SpringsAlone pushed(sandwich, sandwich.pulled(-3e-4, 0.0, 1));
  EXPECT_EQ(pushed.force.norm(), 0.0);
}

TEST(WallSprings, WhereWallsTouchAreLinear) {
  Sandwich sandwich;
  sandwich.springs.erase(sandwich.springs.begin(), sandwich.springs.begin() + 2);
  const SpringsAlone rest(sandwich, sandwich.mesh.rest_positions);
  EXPECT_LT(rest.force.norm(), 1e-12);
  const WallSpring& spring = sandwich.springs[0];
  EXPECT_NEAR(rest.tangent(3 * spring.outer[0], 3 * spring.outer[0]), 60.0, 1e-9);
  EXPECT_NEAR(rest.tangent(3 * spring.outer[0] + 1, 3 * spring.inner[0] + 1), -60.0, 1e-9);
}

TEST(WallSprings, BrokenOnesCarryNothingUntilMended) {
  const Sandwich sandwich;
  Tissue tissue = sandwich.make();
  Tissue without = Tissue::create(sandwich.mesh, {{1e4, 0.4, 1000.0}}, sandwich.supports, {}).value();
  const Eigen::Matrix3Xd x = sandwich.pulled(1e-3, 2e-4, 9);
  for (int s = 0; s < tissue.n_springs(); ++s) tissue.set_spring_intact(s, false);
  tissue.assemble(x, kStatic);
  without.assemble(x, kStatic);
  EXPECT_EQ((tissue.internal_force() - without.internal_force()).norm(), 0.0);
  EXPECT_EQ((full(tissue.system_matrix()) - full(without.system_matrix())).norm(), 0.0);
  EXPECT_EQ(tissue.elastic_energy(), without.elastic_energy());
  EXPECT_EQ(tissue.spring_tension(1), 0.0);
  EXPECT_GT(tissue.spring_length(1), 0.0);
  tissue.set_spring_intact(1, true);
  tissue.assemble(x, kStatic);
  EXPECT_GT(tissue.spring_tension(1), 0.0);
  EXPECT_EQ(tissue.spring_tension(0), 0.0);
}

}  // namespace
}  // namespace lipofill::solid::testing
