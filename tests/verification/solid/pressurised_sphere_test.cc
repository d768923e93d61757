// Thick sphere under inner pressure (verification case 9), an eighth of it, EAS-9 through the wall.
// Lame's solution:
//     u(a) = p a / (2 E (b^3 - a^3)) (2 (1 - 2 nu) a^3 + (1 + nu) b^3)

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/record.h"
#include "tests/verification/solid/block_mesh.h"
#include "tests/verification/solid/static_solver.h"

namespace lipofill::solid::testing {
namespace {

using verification::Case;
using verification::with_number;

constexpr double kInner = 0.010;
constexpr double kOuter = 0.020;

/// Three blocks, one round each axis, each a third of the eighth.
HexMesh make_eighth(int n) {
  BlockMesh blocks(1e-6 * kInner);
  for (int axis = 0; axis < 3; ++axis) {
    blocks.add_block({n, n, n}, true, [axis](const Eigen::Vector3d& s) -> Eigen::Vector3d {
      Eigen::Vector3d direction;
      direction[axis] = 1.0;
      direction[(axis + 1) % 3] = std::tan(0.25 * M_PI * s[0]);
      direction[(axis + 2) % 3] = std::tan(0.25 * M_PI * s[1]);
      return (kInner + (kOuter - kInner) * s[2]) * direction.normalized();
    });
  }
  return blocks.finish();
}

double inner_displacement(int n, double nu) {
  const HexMesh mesh = make_eighth(n);
  NodeSupports supports;
  for (int a = 0; a < mesh.n_nodes(); ++a) {
    const Eigen::Vector3d X = mesh.rest_positions.col(a);
    supports.fixed.push_back({X[0] < 1e-9, X[1] < 1e-9, X[2] < 1e-9});
  }
  Tissue tissue = Tissue::create(mesh, {{20e3, nu, 1000.0}}, supports, {}).value();
  const auto is_inner = [&](int e) { return e % (n * n * n) < n * n; };
  const Eigen::Matrix3Xd u = solve_linear(tissue, compute_pressure_force(mesh, is_inner, true, 1e3));
  double sum = 0.0;
  int count = 0;
  for (int a = 0; a < mesh.n_nodes(); ++a) {
    if (mesh.rest_positions.col(a).norm() > kInner * (1.0 + 1e-9)) continue;
    sum += u.col(a).norm();
    ++count;
  }
  return sum / count;
}

void expect_displacement(double nu, double expected) {
  Case sphere({"solid/9b-sphere", "Thick sphere under inner pressure", "Lame's solution."});
  const std::string name = with_number("u(a), nu %g", nu);
  const double coarse = inner_displacement(4, nu);
  const double fine = inner_displacement(8, nu);
  sphere.record({name + ", 8 elements through the wall", "mm", 1e3 * expected, 1e3 * fine, 0.012});
  sphere.record({name + ", extrapolated from 4 and 8", "mm", 1e3 * expected, 1e3 * (4.0 * fine - coarse) / 3.0, 0.002});
  sphere.record_series(
      {name, "elements through the wall", {4, 8}, {coarse / expected - 1.0, fine / expected - 1.0}, 2.0, 1.8});
}

TEST(PressurisedSphere, Nu045) {
  expect_displacement(0.45, 0.42143e-3);
}
TEST(PressurisedSphere, Nu049) {
  expect_displacement(0.49, 0.42714e-3);
}

}  // namespace
}  // namespace lipofill::solid::testing
