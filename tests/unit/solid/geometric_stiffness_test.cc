#include "core/solid/geometric_stiffness.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "core/solid/element_assembler.h"
#include "core/solid/tissue.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

const ElasticMaterial kMaterial{1e5, 0.3, 1000.0};

struct Bar {
  Box box{{3, 1, 1}, {0.03, 0.01, 0.005}};
  HexMesh mesh = box.make();
  SystemPattern pattern{mesh.n_nodes(), mesh.hexahedra,
                        std::vector<std::array<bool, 3>>(mesh.n_nodes(), {false, false, false})};

  Eigen::MatrixXd geometric_stiffness(const Eigen::Matrix3Xd& x) const {
    Eigen::SparseMatrix<double> K_G = pattern.make_matrix();
    Eigen::VectorXd stiffness(K_G.nonZeros());
    Eigen::Matrix4Xd positions = Eigen::Matrix4Xd::Zero(4, x.cols());
    positions.topRows<3>() = x;
    Eigen::Matrix4Xd force = Eigen::Matrix4Xd::Zero(4, x.cols());
    std::vector<int> squeezed;
    NodeBlocks blocks(pattern);
    blocks.set_zero();
    const ElementAssembler assembler(mesh, {kMaterial}, pattern);
    const std::vector<double> moduli = assembler.spread_moduli(mesh, {kMaterial.youngs_modulus});
    assembler.add(moduli, positions, force, squeezed, blocks);
    blocks.write(pattern, {}, 0.0, stiffness.data(), K_G.valuePtr());
    return Eigen::MatrixXd(Eigen::SparseMatrix<double>(K_G.selfadjointView<Eigen::Lower>()));
  }
};

/// A linear field u = G X costs V tr(G S+ G^T) under a homogeneous stress; here uniaxial strain
/// with lateral compression left out.
TEST(GeometricStiffness, CostOfALinearFieldIsThatOfTheTension) {
  const Bar bar;
  const Eigen::Vector3d stretch(1.08, 0.95, 1.0);
  const Eigen::Matrix3Xd x = stretch.asDiagonal() * bar.mesh.rest_positions;
  const Eigen::Vector3d E = 0.5 * (stretch.array().square() - 1.0);
  const double mu = 1e5 / 2.6;
  const double lambda = 1e5 * 0.3 / (1.3 * 0.4);
  const Eigen::Vector3d S = (lambda * E.sum() + 2.0 * mu * E.array()).cwiseMax(0.0);
  ASSERT_EQ(S[1], 0.0);
  Jitter jitter(1);
  Eigen::Matrix3d G;
  for (int c = 0; c < 3; ++c) G.col(c) = jitter.next_vector();
  const Eigen::Matrix3Xd field = G * bar.mesh.rest_positions;
  const Eigen::Map<const Eigen::VectorXd> u(field.data(), field.size());
  const double expected = bar.box.size.prod() * (G * S.asDiagonal() * G.transpose()).trace();
  EXPECT_NEAR(u.dot(bar.geometric_stiffness(x) * u), expected, 1e-11 * expected);
}

/// Against Eigen's solver: full, isotropic, of one and of two directions, nothing at all.
TEST(GeometricStiffness, PositivePartIsThatOfTheEigenvalues) {
  Jitter jitter(3);
  for (int k = 0; k < 50; ++k) {
    Lanes entries[6];
    Eigen::Matrix3d expected[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      Eigen::Matrix3d full;
      for (int c = 0; c < 3; ++c) full.col(c) = jitter.next_vector();
      const Eigen::Vector3d n = full.col(0).normalized();
      const Eigen::Matrix3d kinds[] = {full + full.transpose(), 2.0 * Eigen::Matrix3d::Identity(), n * n.transpose(),
                                       n * n.transpose() - Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero()};
      const Eigen::Matrix3d stress = std::pow(10.0, k % 9 - 6) * kinds[(k + lane) % 5];
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(stress);
      expected[lane] =
          eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
      for (int i = 0; i < 6; ++i) entries[i][lane] = stress(i % 3, i < 3 ? i : (i + 1) % 3);
    }
    take_positive_part(entries);
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int i = 0; i < 6; ++i) {
        EXPECT_NEAR(entries[i][lane], expected[lane](i % 3, i < 3 ? i : (i + 1) % 3),
                    1e-14 * std::pow(10.0, k % 9 - 6));
      }
    }
  }
}

TEST(GeometricStiffness, IsPositiveWhateverTheStress) {
  const Bar bar;
  Jitter jitter(2);
  for (int k = 0; k < 10; ++k) {
    Eigen::Matrix3Xd x = bar.mesh.rest_positions;
    for (int a = 0; a < x.cols(); ++a) x.col(a) += 2e-3 * jitter.next_vector();
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(bar.geometric_stiffness(x)).eigenvalues();
    EXPECT_GT(values.minCoeff(), -1e-12 * values.maxCoeff());
  }
}

TEST(GeometricStiffness, IsNothingUnderCompressionOrRotation) {
  const Bar bar;
  const double scale = bar.geometric_stiffness(1.1 * bar.mesh.rest_positions).norm();
  EXPECT_LT(bar.geometric_stiffness(0.9 * bar.mesh.rest_positions).norm(), 1e-13 * scale);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_LT(bar.geometric_stiffness(R * bar.mesh.rest_positions).norm(), 1e-13 * scale);
}

/// Turning a stretched bar: the derivative of the force has the tension's part, which K alone
/// leaves out.
TEST(GeometricStiffness, BringsTheTangentNearTheDerivative) {
  constexpr double kStatic = std::numeric_limits<double>::infinity();
  const Bar bar;
  Tissue tissue = Tissue::create(bar.mesh, {kMaterial}, {}, {}).value();
  const Eigen::Matrix3Xd x = Eigen::Vector3d(1.05, 0.985, 0.985).asDiagonal() * bar.mesh.rest_positions;
  Eigen::Matrix3Xd field = Eigen::Matrix3Xd::Zero(3, x.cols());
  field.row(1) = x.row(0);  // a turn about z, seen from the bar's axis
  field.row(0) = -x.row(1);
  const Eigen::Map<const Eigen::VectorXd> u(field.data(), field.size());
  const double h = 1e-6;
  tissue.assemble(x + h * field, kStatic);
  const Eigen::VectorXd forward = tissue.internal_force();
  tissue.assemble(x - h * field, kStatic);
  const double derivative = u.dot(forward - tissue.internal_force()) / (2.0 * h);
  tissue.assemble(x, kStatic);
  const double with_tension = u.dot(tissue.system_matrix().selfadjointView<Eigen::Lower>() * u);
  const double without = u.dot(tissue.stiffness_times(u));
  EXPECT_LT(std::abs(with_tension - derivative), 0.2 * std::abs(without - derivative))
      << derivative << " with " << with_tension << " without " << without;
}

}  // namespace
}  // namespace lipofill::solid::testing
