#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "core/solid/incompatible_modes.h"
#include "core/solid/material.h"
#include "core/solid/solid_shell.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

struct ElementKind {
  const char* name;
  HexStiffness (*compute)(const HexNodes&, const Eigen::Matrix<double, 6, 6>&);
};

class ElementTest : public ::testing::TestWithParam<ElementKind> {
 protected:
  static Eigen::Matrix<double, 6, 6> elasticity(double nu) { return compute_elasticity_matrix({1e5, nu, 1000.0}); }

  /// A plate-like hexahedron with every corner moved.
  static HexNodes distorted(unsigned seed) {
    const Eigen::DiagonalMatrix<double, 3> half_size(2e-3, 1.5e-3, 0.5e-3);
    Jitter jitter(seed);
    HexNodes nodes = hex_corners();
    for (int a = 0; a < 8; ++a) nodes.col(a) += 0.3 * jitter.next_vector();
    return half_size * nodes;
  }
};

TEST_P(ElementTest, IsSymmetricWithSixZeroModes) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const double nu : {0.0, 0.3, 0.45, 0.499}) {
      const HexStiffness K = GetParam().compute(distorted(seed), elasticity(nu));
      EXPECT_EQ((K - K.transpose()).cwiseAbs().maxCoeff(), 0.0);
      const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<HexStiffness>(K).eigenvalues();
      EXPECT_LT(values.head<6>().cwiseAbs().maxCoeff(), 1e-12 * values[23]) << "seed " << seed << " nu " << nu;
      EXPECT_GT(values[6], 1e-6 * values[23]) << "seed " << seed << " nu " << nu;
    }
  }
}

TEST_P(ElementTest, RigidMotionsCostNothing) {
  const HexNodes nodes = distorted(5);
  const HexStiffness K = GetParam().compute(nodes, elasticity(0.45));
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
  HexNodes u;
  for (int a = 0; a < 8; ++a) u.col(a) = axis.cross(nodes.col(a)) + Eigen::Vector3d(1e-3, 2e-3, -1e-3);
  const Eigen::Map<const Eigen::Matrix<double, 24, 1>> d(u.data());
  EXPECT_LT((K * d).norm(), 1e-12 * K.norm() * d.norm());
}

TEST_P(ElementTest, TurnsWithItsNodes) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  const HexStiffness K = GetParam().compute(distorted(7), elasticity(0.45));
  const HexStiffness turned = GetParam().compute(R * distorted(7), elasticity(0.45));
  HexStiffness expected;
  for (int a = 0; a < 8; ++a) {
    for (int b = 0; b < 8; ++b) expected.block<3, 3>(3 * a, 3 * b) = R * K.block<3, 3>(3 * a, 3 * b) * R.transpose();
  }
  EXPECT_LT((turned - expected).norm(), 1e-12 * K.norm());
}

/// Uniaxial stress of a single cuboid: F = E A / L u whatever nu, if the sides may contract.
TEST_P(ElementTest, StretchesByYoungsModulus) {
  const double nu = 0.45;
  const HexNodes nodes = hex_corners();  // 2 x 2 x 2 m
  HexNodes u;
  for (int a = 0; a < 8; ++a) u.col(a) = Eigen::Vector3d(nodes(0, a), -nu * nodes(1, a), -nu * nodes(2, a)) * 1e-3;
  const HexStiffness K = GetParam().compute(nodes, elasticity(nu));
  const Eigen::Matrix<double, 24, 1> f = K * Eigen::Map<const Eigen::Matrix<double, 24, 1>>(u.data());
  for (int a = 0; a < 8; ++a) {
    // E * strain * a quarter of the face's 4 m2
    EXPECT_NEAR(f[3 * a], 1e5 * 1e-3 * nodes(0, a), 1e-8);
    EXPECT_NEAR(f[3 * a + 1], 0.0, 1e-8);
    EXPECT_NEAR(f[3 * a + 2], 0.0, 1e-8);
  }
}

/// Scaling lengths by s scales a stiffness by s.
TEST_P(ElementTest, ScalesWithLength) {
  const HexStiffness K = GetParam().compute(distorted(3), elasticity(0.3));
  const HexStiffness scaled = GetParam().compute(1000.0 * distorted(3), elasticity(0.3));
  EXPECT_LT((scaled - 1000.0 * K).norm(), 1e-11 * scaled.norm());
}

INSTANTIATE_TEST_SUITE_P(Kinds, ElementTest,
                         ::testing::Values(ElementKind{"solid_shell", compute_solid_shell_stiffness},
                                           ElementKind{"eas9", compute_incompatible_modes_stiffness}),
                         [](const auto& kind) { return kind.param.name; });

}  // namespace
}  // namespace lipofill::solid::testing
