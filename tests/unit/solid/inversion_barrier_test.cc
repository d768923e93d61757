#include "core/solid/inversion_barrier.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <limits>

#include "core/solid/hex_quality.h"
#include "core/solid/hex_shape.h"
#include "core/solid/tissue.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

constexpr double kModulus = 3e3;

/// Four distorted hexahedra with every node free, and what the barrier says of them.
struct Slab {
  Box box{{2, 2, 1}, {0.01, 0.008, 0.003}};
  HexMesh mesh = box.make();
  SystemPattern pattern{mesh.n_nodes(), mesh.hexahedra,
                        std::vector<std::array<bool, 3>>(mesh.n_nodes(), {false, false, false})};

  Slab() { distort_in_plane(box, 0.2, 1, mesh); }

  struct Result {
    double energy;
    Eigen::VectorXd force;
    Eigen::MatrixXd tangent;
  };

  Result evaluate(const Eigen::Matrix3Xd& x) const {
    Eigen::SparseMatrix<double> K = pattern.make_matrix();
    Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(K.nonZeros());
    TangentValues values{stiffness.data(), K.valuePtr(), 1.0};
    Eigen::Matrix4Xd positions = Eigen::Matrix4Xd::Zero(4, x.cols());
    positions.topRows<3>() = x;
    Eigen::Matrix4Xd force = Eigen::Matrix4Xd::Zero(4, x.cols());
    const InversionBarrier barrier(mesh);
    Result result{0.0, {}, {}};
    for (int e = 0; e < mesh.n_hexahedra(); ++e) {
      result.energy += barrier.add_force(e, kModulus, positions, force);
      barrier.add_tangent(e, kModulus, positions, pattern, values);
    }
    result.force = Eigen::Matrix3Xd(force.topRows<3>()).reshaped();
    result.tangent = Eigen::MatrixXd(Eigen::SparseMatrix<double>(K.selfadjointView<Eigen::Lower>()));
    return result;
  }

  /// Flattened to a share of the thickness and shaken.
  Eigen::Matrix3Xd flattened(double share, double amplitude, unsigned seed) const {
    Eigen::Matrix3Xd x = mesh.rest_positions;
    x.row(2) *= share;
    Jitter jitter(seed);
    for (int a = 0; a < x.cols(); ++a) x.col(a) += amplitude * jitter.next_vector();
    return x;
  }
};

/// b of the docstring, its parabola included, by its definition.
double expected_density(double j) {
  const auto b = [](double s) { return -(s - 1.0) * (s - 1.0) * std::log(s); };
  if (j >= 1.0) return 0.0;
  const double m = InversionBarrier::kLeastShare;
  if (j >= m) return b(j);
  const double h = 1e-4;
  const double slope = (b(m + h * m) - b(m - h * m)) / (2.0 * h * m);
  const double curvature = (b(m + h * m) - 2.0 * b(m) + b(m - h * m)) / (h * h * m * m);
  return b(m) + slope * (j - m) + 0.5 * curvature * (j - m) * (j - m);
}

/// Uniform flattening leaves every corner the same share.
TEST(InversionBarrier, EnergyIsThatOfTheDocstring) {
  const Slab slab;
  for (const double share : {0.29, 0.2, 0.05, 0.014, -0.1}) {
    double volume = 0.0;
    for (int e = 0; e < slab.mesh.n_hexahedra(); ++e) {
      volume += 8.0 * compute_jacobian(slab.mesh.gather(e, slab.mesh.rest_positions), LocalPoint::Zero()).determinant();
    }
    const double expected = kModulus * volume * expected_density(share / InversionBarrier::kThreshold);
    EXPECT_NEAR(slab.evaluate(slab.flattened(share, 0.0, 1)).energy, expected, 1e-6 * expected) << share;
  }
}

TEST(InversionBarrier, IsNothingAboveTheThreshold) {
  const Slab slab;
  for (const double share : {2.0, 1.0, 0.301}) {
    const Slab::Result result = slab.evaluate(slab.flattened(share, 0.0, 1));
    EXPECT_EQ(result.energy, 0.0);
    EXPECT_EQ(result.force.norm(), 0.0);
    EXPECT_EQ(result.tangent.norm(), 0.0);
  }
  const Eigen::Matrix3d R = Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 1, -2).normalized()).toRotationMatrix();
  EXPECT_EQ(slab.evaluate(R * slab.mesh.rest_positions).energy, 0.0);
}

TEST(InversionBarrier, ForceIsTheSlopeOfTheEnergy) {
  const Slab slab;
  for (const double share : {0.25, 0.1, -0.05}) {
    const Eigen::Matrix3Xd x = slab.flattened(share, 5e-5, 2);
    const Eigen::VectorXd force = slab.evaluate(x).force;
    ASSERT_GT(force.norm(), 0.0);
    Eigen::Matrix3Xd direction(3, x.cols());
    Jitter jitter(3);
    for (int a = 0; a < x.cols(); ++a) direction.col(a) = jitter.next_vector();
    const double h = 1e-9;
    const double slope =
        (slab.evaluate(x + h * direction).energy - slab.evaluate(x - h * direction).energy) / (2.0 * h);
    const double expected = force.dot(Eigen::Map<const Eigen::VectorXd>(direction.data(), direction.size()));
    EXPECT_NEAR(slope, expected, 1e-4 * force.norm() * direction.norm()) << share;
  }
}

/// The whole second derivative less its negative part: never softer than the truth, equal to it
/// where that is positive.
TEST(InversionBarrier, TangentIsPositiveAndBoundsTheTruth) {
  const Slab slab;
  for (const double share : {0.25, 0.1, -0.05}) {
    const Eigen::Matrix3Xd x = slab.flattened(share, 5e-5, 4);
    const Slab::Result at = slab.evaluate(x);
    Eigen::MatrixXd derivative(x.size(), x.size());
    const double h = 1e-9;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      Eigen::Matrix3Xd moved = x;
      moved.data()[i] += h;
      derivative.col(i) = slab.evaluate(moved).force;
      moved.data()[i] -= 2.0 * h;
      derivative.col(i) = (derivative.col(i) - slab.evaluate(moved).force) / (2.0 * h);
    }
    const Eigen::MatrixXd truth = 0.5 * (derivative + derivative.transpose());
    const double scale = at.tangent.norm();
    using Solver = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;
    EXPECT_GT(Solver(at.tangent).eigenvalues().minCoeff(), -1e-12 * scale);
    EXPECT_GT(Solver(at.tangent - truth).eigenvalues().minCoeff(), -1e-4 * scale);
    const double stiffest = Solver(truth).eigenvalues().maxCoeff();
    EXPECT_NEAR(Solver(at.tangent).eigenvalues().maxCoeff(), stiffest, 0.05 * stiffest);
  }
}

TEST(InversionBarrier, TurnsWithTheTissueAndPushesOnNothingOutside) {
  const Slab slab;
  const Eigen::Matrix3Xd x = slab.flattened(0.15, 5e-5, 5);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.2, Eigen::Vector3d(3, -1, 2).normalized()).toRotationMatrix();
  const Slab::Result before = slab.evaluate(x);
  const Slab::Result after = slab.evaluate((R * x).colwise() + Eigen::Vector3d(0.1, 0.2, -0.3));
  EXPECT_NEAR(after.energy, before.energy, 1e-9 * before.energy);
  Eigen::Vector3d total = Eigen::Vector3d::Zero();
  for (int a = 0; a < x.cols(); ++a) {
    total += before.force.segment<3>(3 * a);
    EXPECT_LT((after.force.segment<3>(3 * a) - R * before.force.segment<3>(3 * a)).norm(), 1e-8 * before.force.norm());
  }
  EXPECT_LT(total.norm(), 1e-12 * before.force.norm());
}

/// Soft fat on bone, 20 x 20 x 3 mm, pressed in its middle by its modulus: Newton's method with the
/// system matrix, no line search. Without the barrier the equilibrium has folded corners (scaled
/// Jacobian -0.19).
TEST(InversionBarrier, SoftFatUnderALoadComesToRest) {
  const Box box{{8, 8, 1}, {0.02, 0.02, 0.003}};
  NodeSupports supports;
  supports.fixed.resize(box.n_nodes());
  Eigen::VectorXd load = Eigen::VectorXd::Zero(3 * box.n_nodes());
  for_each_node(box, [&](int a, int i, int j, int k) {
    supports.fixed[a] = {k == 0, k == 0, k == 0};
    const bool middle = k == 1 && std::abs(i - 4) <= 1 && std::abs(j - 4) <= 1;
    if (middle) load[3 * a + 2] = -kModulus * 0.0025 * 0.0025;
  });
  Tissue tissue = Tissue::create(box.make(), {{kModulus, 0.49, 920.0}}, supports, {}).value();
  Eigen::Matrix3Xd x = tissue.mesh().rest_positions;
  double residual = 1.0;
  int iterations = 0;
  for (; residual > 1e-8 && iterations < 100; ++iterations) {
    tissue.assemble(x, std::numeric_limits<double>::infinity());
    Eigen::VectorXd unbalanced(tissue.n_dofs());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const int dof = tissue.dof_of_component()[i];
      if (dof >= 0) unbalanced[dof] = load[i] - tissue.internal_force()[dof];
    }
    residual = unbalanced.norm() / load.norm();
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver(tissue.system_matrix());
    const Eigen::VectorXd step = solver.solve(unbalanced);
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (tissue.dof_of_component()[i] >= 0) x.data()[i] += step[tissue.dof_of_component()[i]];
    }
  }
  EXPECT_LT(residual, 1e-8);
  EXPECT_GT(compute_min_scaled_jacobian(tissue.mesh(), x), 0.0);
}

}  // namespace
}  // namespace lipofill::solid::testing
