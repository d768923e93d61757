#include "core/solid/prestress.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "core/solid/tissue.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

constexpr double kStatic = std::numeric_limits<double>::infinity();
constexpr double kTension = 5e3;

/// A sheet, distorted in its plane, that may be turned as a whole.
struct Sheet {
  Box box{{3, 2, 1}, {0.03, 0.02, 0.002}};
  HexMesh mesh = box.make();

  explicit Sheet(const Eigen::Matrix3d& turned = Eigen::Matrix3d::Identity()) {
    distort_in_plane(box, 0.2, 1, mesh);
    mesh.rest_positions = turned * mesh.rest_positions;
  }
  Tissue make(double tension) const { return Tissue::create(mesh, {{1e5, 0.3, 1000.0, tension}}, {}, {}).value(); }
};

/// What tension adds to a tissue at the positions x.
struct TensionAlone {
  double energy;
  Eigen::VectorXd force;
  Eigen::MatrixXd stiffness;

  TensionAlone(const Sheet& sheet, const Eigen::Matrix3Xd& x) {
    Tissue with = sheet.make(kTension);
    Tissue without = sheet.make(0.0);
    with.assemble(x, kStatic);
    without.assemble(x, kStatic);
    energy = with.elastic_energy() - without.elastic_energy();
    force = with.internal_force() - without.internal_force();
    const Eigen::SparseMatrix<double> difference = with.system_matrix() - without.system_matrix();
    stiffness = Eigen::MatrixXd(Eigen::SparseMatrix<double>(difference.selfadjointView<Eigen::Lower>()));
  }
};

Eigen::Matrix3Xd shake(const Eigen::Matrix3Xd& x, double amplitude, unsigned seed) {
  Jitter jitter(seed);
  Eigen::Matrix3Xd shaken = x;
  for (int a = 0; a < x.cols(); ++a) shaken.col(a) += amplitude * jitter.next_vector();
  return shaken;
}

/// u = G X costs V/2 tr(G S0 G^T); the in-plane gradients of a lifted sheet count, those through
/// its thickness do not.
TEST(Prestress, EnergyOfALinearField) {
  const Sheet sheet;
  Jitter jitter(2);
  Eigen::Matrix3d G;
  for (int c = 0; c < 3; ++c) G.col(c) = 0.01 * jitter.next_vector();
  const TensionAlone tension(sheet, (Eigen::Matrix3d::Identity() + G) * sheet.mesh.rest_positions);
  const double expected = 0.5 * sheet.box.size.prod() * kTension * (G.col(0).squaredNorm() + G.col(1).squaredNorm());
  EXPECT_NEAR(tension.energy, expected, 1e-9 * expected);
}

TEST(Prestress, RestIsInEquilibrium) {
  const Sheet sheet;
  const TensionAlone tension(sheet, sheet.mesh.rest_positions);
  EXPECT_EQ(tension.force.norm(), 0.0);
  EXPECT_EQ(tension.energy, 0.0);
}

/// Energy 1/2 u K u, force K u, on any displacement: they come by different routes.
TEST(Prestress, ForceStiffnessAndEnergyAgree) {
  const Sheet sheet;
  const Eigen::Matrix3Xd x = shake(sheet.mesh.rest_positions, 1e-3, 3);
  const TensionAlone tension(sheet, x);
  const Eigen::Matrix3Xd displacement = x - sheet.mesh.rest_positions;
  const Eigen::Map<const Eigen::VectorXd> u(displacement.data(), displacement.size());
  EXPECT_LT((tension.force - tension.stiffness * u).norm(), 1e-9 * tension.force.norm());
  EXPECT_NEAR(tension.energy, 0.5 * u.dot(tension.force), 1e-9 * tension.energy);
}

TEST(Prestress, StiffnessIsPositive) {
  const Sheet sheet;
  const TensionAlone tension(sheet, sheet.mesh.rest_positions);
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(tension.stiffness).eigenvalues();
  EXPECT_GT(values.minCoeff(), -1e-9 * values.maxCoeff());
}

/// Rest shape and deformed shape turned alike: the force turns along.
TEST(Prestress, TurnsWithTheRestShape) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.9, Eigen::Vector3d(2, 1, -1).normalized()).toRotationMatrix();
  const Sheet sheet;
  const Sheet turned(R);
  const Eigen::Matrix3Xd x = shake(sheet.mesh.rest_positions, 5e-4, 4);
  const TensionAlone before(sheet, x);
  const TensionAlone after(turned, R * x);
  EXPECT_NEAR(after.energy, before.energy, 1e-9 * before.energy);
  for (int a = 0; a < x.cols(); ++a) {
    EXPECT_LT((after.force.segment<3>(3 * a) - R * before.force.segment<3>(3 * a)).norm(), 1e-9 * before.force.norm());
  }
}

/// Only the material that has it: the other layer is as without.
TEST(Prestress, IsThatOfTheLayer) {
  Sheet sheet;
  Tissue without = sheet.make(0.0);
  sheet.mesh.material[0] = 1;
  const std::vector<ElasticMaterial> materials = {{1e5, 0.3, 1000.0}, {1e5, 0.3, 1000.0, kTension}};
  Tissue tissue = Tissue::create(sheet.mesh, materials, {}, {}).value();
  Eigen::Matrix3Xd x = sheet.mesh.rest_positions;
  x.col(sheet.box.node(3, 2, 1))[2] += 1e-3;  // a corner of the last element, which has no tension
  tissue.assemble(x, kStatic);
  without.assemble(x, kStatic);
  EXPECT_EQ((tissue.internal_force() - without.internal_force()).norm(), 0.0);
  x.col(0)[2] += 1e-3;
  tissue.assemble(x, kStatic);
  without.assemble(x, kStatic);
  EXPECT_GT((tissue.internal_force() - without.internal_force()).norm(), 0.0);
}

}  // namespace
}  // namespace lipofill::solid::testing
