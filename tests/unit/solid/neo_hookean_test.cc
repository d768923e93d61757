// The neo-Hookean hexahedron: its force is the slope of its energy, its tangent at rest that of its
// force, it knows no rotation, and what it shares with the linear elements at rest is theirs.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "core/solid/geometric_stiffness.h"
#include "core/solid/tissue.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

constexpr double kStatic = std::numeric_limits<double>::infinity();

ElasticMaterial neo_hookean(double nu) {
  return {3e3, nu, 1000.0, 0.0, TissueLaw::kNeoHookean};
}

/// Hexahedra of every shape: 3 x 2 x 2 of them, so that a batch is not full, all nodes moved.
struct Slab {
  Box box{{3, 2, 2}, {0.006, 0.004, 0.003}};
  HexMesh mesh;
  Tissue tissue;

  explicit Slab(bool stacked, double nu = 0.49) : mesh(make(stacked)), tissue(make_tissue(nu)) {}
  HexMesh make(bool stacked) {
    box.stacked = stacked;
    HexMesh made = box.make();
    Jitter jitter(3);
    for (int a = 0; a < made.n_nodes(); ++a) made.rest_positions.col(a) += 2.5e-4 * jitter.next_vector();
    return made;
  }
  Tissue make_tissue(double nu) { return Tissue::create(mesh, {neo_hookean(nu)}, {}, {}).value(); }

  /// Stretched, sheared and crumpled.
  Eigen::Matrix3Xd deformed() const {
    Eigen::Matrix3d A;
    A << 1.3, 0.3, 0.0, -0.1, 0.9, 0.2, 0.1, 0.0, 0.8;
    Eigen::Matrix3Xd x = A * mesh.rest_positions;
    Jitter jitter(4);
    for (int a = 0; a < x.cols(); ++a) x.col(a) += 2e-4 * jitter.next_vector();
    return x;
  }
  Eigen::VectorXd force(const Eigen::Matrix3Xd& x) {
    tissue.compute_force(x);
    return tissue.internal_force();
  }
  Eigen::VectorXd slope_of_energy(Eigen::Matrix3Xd x) {
    const double h = 1e-8;
    Eigen::VectorXd slope(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const double at = x.data()[i];
      x.data()[i] = at + h;
      tissue.compute_force(x);
      slope[i] = tissue.elastic_energy();
      x.data()[i] = at - h;
      tissue.compute_force(x);
      slope[i] = (slope[i] - tissue.elastic_energy()) / (2.0 * h);
      x.data()[i] = at;
    }
    return slope;
  }
  Eigen::MatrixXd slope_of_force(Eigen::Matrix3Xd x) {
    const double h = 1e-8;
    Eigen::MatrixXd slope(x.size(), x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const double at = x.data()[i];
      x.data()[i] = at + h;
      slope.col(i) = force(x);
      x.data()[i] = at - h;
      slope.col(i) = (slope.col(i) - force(x)) / (2.0 * h);
      x.data()[i] = at;
    }
    return slope;
  }
  Eigen::MatrixXd tangent(const Eigen::Matrix3Xd& x) {
    tissue.assemble(x, kStatic);
    const Eigen::MatrixXd lower = tissue.system_matrix();
    return lower.selfadjointView<Eigen::Lower>();
  }
};

class NeoHookean : public ::testing::TestWithParam<bool> {};

TEST_P(NeoHookean, HasNoForceAtRest) {
  Slab slab(GetParam());
  const double reference = slab.force(1.01 * slab.mesh.rest_positions).norm();
  EXPECT_LT(slab.force(slab.mesh.rest_positions).norm(), 1e-12 * reference);
  slab.tissue.compute_force(slab.mesh.rest_positions);
  EXPECT_NEAR(slab.tissue.elastic_energy(), 0.0, 1e-18);
}

TEST_P(NeoHookean, ForceIsTheSlopeOfTheEnergy) {
  Slab slab(GetParam());
  const Eigen::Matrix3Xd x = slab.deformed();
  const Eigen::VectorXd force = slab.force(x);
  EXPECT_LT((slab.slope_of_energy(x) - force).norm(), 1e-6 * force.norm());
}

/// The law has a continuation below J = 0.05; energy and force have no step there, and stay finite
/// beyond.
TEST_P(NeoHookean, StaysFiniteInsideOut) {
  Slab slab(GetParam());
  for (const double height : {0.06, 0.05, 0.04, 0.0, -0.5}) {
    Eigen::Matrix3Xd x = slab.mesh.rest_positions;
    x.row(2) *= height;
    EXPECT_TRUE(slab.force(x).allFinite()) << height;
    EXPECT_TRUE(std::isfinite(slab.tissue.elastic_energy())) << height;
    EXPECT_NEAR(slab.tissue.min_volume_ratio(), height, 1e-12);
    EXPECT_EQ(slab.tissue.is_folded(), height <= 0.0);
  }
}

TEST_P(NeoHookean, TangentAtRestIsTheSlopeOfTheForce) {
  Slab slab(GetParam());
  const Eigen::MatrixXd slope = slab.slope_of_force(slab.mesh.rest_positions);
  const Eigen::MatrixXd tangent = slab.tangent(slab.mesh.rest_positions);
  EXPECT_LT((tangent - slope).norm(), 1e-6 * slope.norm());
}

/// Elsewhere the tangent leaves out what is of the order of the strain, and keeps no negative
/// eigenvalue.
TEST_P(NeoHookean, TangentIsDefiniteAndNearTheSlopeOfTheForce) {
  Slab slab(GetParam());
  const Eigen::Matrix3Xd x = slab.deformed();
  const Eigen::MatrixXd tangent = slab.tangent(x);
  const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(tangent).eigenvalues();
  EXPECT_GT(eigenvalues[0], -1e-12 * eigenvalues[eigenvalues.size() - 1]);
  const Eigen::MatrixXd slope = slab.slope_of_force(x);
  EXPECT_LT((tangent - slope).norm(), 0.3 * slope.norm());
}

TEST_P(NeoHookean, TurnsWithTheTissue) {
  Slab slab(GetParam());
  const Eigen::Matrix3Xd x = slab.deformed();
  const Eigen::Matrix3Xd force = slab.force(x).reshaped(3, x.cols());
  const double energy = slab.tissue.elastic_energy();
  const Eigen::Matrix3d R = Eigen::AngleAxisd(2.2, Eigen::Vector3d(1, -1, 2).normalized()).toRotationMatrix();
  const Eigen::Matrix3Xd turned = slab.force((R * x).colwise() + Eigen::Vector3d(0.3, 0.1, -0.2)).reshaped(3, x.cols());
  EXPECT_LT((turned - R * force).norm(), 1e-10 * force.norm());
  EXPECT_NEAR(slab.tissue.elastic_energy(), energy, 1e-11 * energy);
}

/// Homogeneous states leave inner nodes in balance, whatever the shapes.
TEST_P(NeoHookean, PassesPatchTestsAtFiniteStrain) {
  const Box box{{4, 3, 3}, {0.008, 0.006, 0.004}, GetParam()};
  HexMesh mesh = box.make();
  distort_inside(box, 0.25, 5, mesh);
  Tissue tissue = Tissue::create(mesh, {neo_hookean(0.4999)}, {}, {}).value();
  Eigen::Matrix3d F;
  F << 1.4, 0.5, 0.0, 0.1, 0.9, -0.3, 0.2, 0.0, 0.7;
  tissue.compute_force(F * mesh.rest_positions);
  const Eigen::Matrix3Xd force = tissue.internal_force().reshaped(3, mesh.n_nodes());
  double inside = 0.0;
  for_each_node(box, [&](int a, int i, int j, int k) {
    const bool is_inside = i > 0 && j > 0 && k > 0 && i < box.n[0] && j < box.n[1] && k < box.n[2];
    if (is_inside) inside = std::max(inside, force.col(a).norm());
  });
  EXPECT_LT(inside, 1e-12 * force.norm());
}

INSTANTIATE_TEST_SUITE_P(Elements, NeoHookean, ::testing::Values(false, true),
                         [](const auto& of) { return of.param ? "Stacked" : "SolidShell"; });

/// Layers of both laws in one tissue: what each adds is what it adds alone.
TEST(NeoHookeanTissue, StandsBesideCorotationalLayers) {
  const Box box{{3, 3, 2}, {0.006, 0.006, 0.004}};
  HexMesh mesh = box.make();
  for (size_t e = 9; e < 18; ++e) mesh.material[e] = 1;
  const ElasticMaterial linear{9e4, 0.45, 1000.0};
  const Eigen::Matrix3Xd x = 1.05 * mesh.rest_positions;
  const auto energy = [&](const ElasticMaterial& lower, const ElasticMaterial& upper) {
    Tissue tissue = Tissue::create(mesh, {lower, upper}, {}, {}).value();
    tissue.assemble(x, kStatic);
    return tissue.elastic_energy();
  };
  const double both = energy(linear, neo_hookean(0.49));
  const double halves = 0.5 * (energy(linear, linear) + energy(neo_hookean(0.49), neo_hookean(0.49)));
  EXPECT_NEAR(both, halves, 1e-12 * halves);
}

/// A column narrower than thick resists a lone node of its face as a solid does: the energy of a
/// node pushed up between its neighbours, in elements a quarter as wide as thick, against the same
/// with eight elements through the thickness.
TEST(NeoHookeanTissue, HasNoSoftModeOfTheThickness) {
  const auto stiffness = [](int through) {
    const Box box{{6, 6, through}, {0.006, 0.006, 0.004}, through > 1};
    NodeSupports supports;
    supports.fixed.assign(box.n_nodes(), {true, true, true});
    const HexMesh mesh = box.make();
    Tissue tissue = Tissue::create(mesh, {neo_hookean(0.3)}, {}, {}).value();
    Eigen::Matrix3Xd x = mesh.rest_positions;
    for (int k = 0; k <= through; ++k) x(2, box.node(3, 3, k)) += 1e-5 * k / through;
    tissue.assemble(x, kStatic);
    return tissue.elastic_energy();
  };
  EXPECT_NEAR(stiffness(1) / stiffness(8), 1.0, 0.15);
}

}  // namespace

/// The share taken is the principal stress nearest to zero, or none.
TEST(TakeTension, LeavesThePositivePartOfWhatIsLeft) {
  const auto take = [](const Eigen::Vector3d& principal, const Eigen::Matrix3d& R, Eigen::Matrix3d& left) {
    const Eigen::Matrix3d S = R * principal.asDiagonal() * R.transpose();
    Lanes entries[6] = {fill_lanes(S(0, 0)), fill_lanes(S(1, 1)), fill_lanes(S(2, 2)),
                        fill_lanes(S(0, 1)), fill_lanes(S(1, 2)), fill_lanes(S(2, 0))};
    const double share = take_tension(entries)[0];
    left << entries[0][0], entries[3][0], entries[5][0],  //
        entries[3][0], entries[1][0], entries[4][0],      //
        entries[5][0], entries[4][0], entries[2][0];
    return share;
  };
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const auto expect = [&](const Eigen::Vector3d& principal, double share, const Eigen::Vector3d& left) {
    Eigen::Matrix3d measured;
    EXPECT_NEAR(take(principal, R, measured), share, 1e-12);
    EXPECT_LT((measured - R * left.asDiagonal() * R.transpose()).norm(), 1e-12);
  };
  expect({3, 2, 1}, 1.0, {2, 1, 0});
  expect({-3, -2, -1}, -1.0, {0, 0, 0});
  expect({3, -2, -1}, 0.0, {3, 0, 0});
}

}  // namespace lipofill::solid::testing
