// Neo-Hookean blocks of distorted elements under uniaxial compression and in simple shear, against
// the closed forms of
//
//     W = mu/2 (J^-2/3 I1 - 3) + kappa/2 (J - 1)^2,   tau = mu J^-2/3 dev(F F^T) + kappa J (J - 1) I

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/unit/solid/box_mesh.h"
#include "tests/verification/record.h"
#include "tests/verification/solid/static_solver.h"

namespace lipofill::solid::testing {
namespace {

using verification::Case;
using verification::with_number;

constexpr double kYoungsModulus = 3e3;
constexpr double kEdge = 0.01;

struct Constants {
  double mu, kappa;
};

Constants constants_of(double nu) {
  return {kYoungsModulus / (2.0 * (1.0 + nu)), kYoungsModulus / (3.0 * (1.0 - 2.0 * nu))};
}

Eigen::Matrix3d compute_kirchhoff_stress(const Eigen::Matrix3d& F, double nu) {
  const auto [mu, kappa] = constants_of(nu);
  const double J = F.determinant();
  const Eigen::Matrix3d b = std::pow(J, -2.0 / 3.0) * F * F.transpose();
  return mu * (b - b.trace() / 3.0 * Eigen::Matrix3d::Identity()) + kappa * J * (J - 1.0) * Eigen::Matrix3d::Identity();
}

/// The side stretch at which the sides of a block of that height are free.
double find_side_stretch(double height, double nu) {
  double low = 0.5, high = 3.0;
  for (int k = 0; k < 200; ++k) {
    const double side = 0.5 * (low + high);
    const Eigen::Matrix3d F = Eigen::Vector3d(side, side, height).asDiagonal();
    (compute_kirchhoff_stress(F, nu)(0, 0) > 0.0 ? high : low) = side;
  }
  return 0.5 * (low + high);
}

Box block_box(bool stacked) {
  return {{4, 3, 3}, {kEdge, kEdge, kEdge}, stacked};
}

Tissue make_block(bool stacked, double nu) {
  const Box box = block_box(stacked);
  HexMesh mesh = box.make();
  distort_inside(box, 0.25, 11, mesh);
  return Tissue::create(mesh, {{kYoungsModulus, nu, 1000.0, 0.0, TissueLaw::kNeoHookean}}, {}, {}).value();
}

Case make_case() {
  return Case({"solid/11a-neo-hookean", "Neo-Hookean block: uniaxial compression, simple shear",
               "The law's closed forms; the elements are distorted, so this is a patch test at finite strain too."});
}

/// Pressed to 0.6 of its height between slippery plates: force and side stretch.
void expect_compression(bool stacked, double nu) {
  constexpr double kHeight = 0.6;
  Tissue tissue = make_block(stacked, nu);
  const Box box = block_box(stacked);
  LargeDeformation problem{{}, tissue.mesh().rest_positions, Eigen::Matrix3Xd::Zero(3, box.n_nodes())};
  problem.held.resize(box.n_nodes());
  for_each_node(box, [&](int a, int i, int j, int k) {
    problem.held[a] = {i == 0, j == 0, k == 0 || k == box.n[2]};
    problem.prescribed(2, a) *= kHeight;
  });
  const StaticState state = solve_large_deformation(tissue, problem, 4);
  ASSERT_TRUE(state.converged);
  double force = 0.0;
  for_each_node(box, [&](int a, int, int, int k) {
    if (k == box.n[2]) force += tissue.internal_force()[3 * a + 2];
  });
  const double side = find_side_stretch(kHeight, nu);
  const Eigen::Matrix3d F = Eigen::Vector3d(side, side, kHeight).asDiagonal();
  const double expected = compute_kirchhoff_stress(F, nu)(2, 2) / kHeight * kEdge * kEdge;
  const std::string name = with_number(stacked ? "stacked, nu %g" : "solid-shell, nu %g", nu);
  Case block = make_case();
  block.record({"pressed to 0.6, force, " + name, "N", expected, force, 1e-6});
  const int corner = box.node(box.n[0], box.n[1], 1);
  block.record({"pressed to 0.6, side stretch, " + name, "1", side, state.x(0, corner) / kEdge, 1e-6});
}

/// All of the surface sheared by 0.8: shear force and the force that holds the plates (Poynting's
/// effect).
void expect_shear(bool stacked, double nu) {
  constexpr double kShear = 0.8;
  Tissue tissue = make_block(stacked, nu);
  const Box box = block_box(stacked);
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F(0, 2) = kShear;
  LargeDeformation problem{{}, F * tissue.mesh().rest_positions, Eigen::Matrix3Xd::Zero(3, box.n_nodes())};
  problem.held.resize(box.n_nodes());
  for_each_node(box, [&](int a, int i, int j, int k) {
    const bool inside = i > 0 && j > 0 && k > 0 && i < box.n[0] && j < box.n[1] && k < box.n[2];
    problem.held[a].fill(!inside);
  });
  ASSERT_TRUE(solve_large_deformation(tissue, problem, 2).converged);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  const auto top_share = [&](int i, int n) { return i == 0 || i == n ? 0.5 : 1.0; };
  for_each_node(box, [&](int a, int i, int j, int k) {
    // Nodes of the rim of the top face carry the sides' traction too.
    const bool inside = top_share(i, box.n[0]) * top_share(j, box.n[1]) == 1.0;
    if (k == box.n[2] && inside) force += tissue.internal_force().segment<3>(3 * a);
  });
  const double area = kEdge * kEdge * (box.n[0] - 1) * (box.n[1] - 1) / (box.n[0] * box.n[1]);
  const Eigen::Vector3d expected = area * (compute_kirchhoff_stress(F, nu) * F.inverse().transpose()).col(2);
  const std::string name = with_number(stacked ? "stacked, nu %g" : "solid-shell, nu %g", nu);
  Case block = make_case();
  block.record({"sheared by 0.8, force along, " + name, "N", expected[0], force[0], 1e-6});
  block.record({"sheared by 0.8, force across, " + name, "N", expected[2], force[2], 1e-6});
}

TEST(NeoHookeanBlock, IsCompressedAsInTheClosedForm) {
  for (const bool stacked : {false, true}) {
    for (const double nu : {0.45, 0.4999}) expect_compression(stacked, nu);
  }
}

TEST(NeoHookeanBlock, IsShearedAsInTheClosedForm) {
  for (const bool stacked : {false, true}) {
    for (const double nu : {0.45, 0.4999}) expect_shear(stacked, nu);
  }
}

}  // namespace
}  // namespace lipofill::solid::testing
