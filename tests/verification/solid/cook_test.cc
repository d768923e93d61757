// Cook's membrane in plane strain (verification case 8): a tapered panel, clamped on its left,
// sheared by a unit force on its right. Trilinear elements lock here; EAS-9 does not. References:
// tip deflection of converged quadratic elements, E = F = 1.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/solid/box_mesh.h"
#include "tests/verification/record.h"
#include "tests/verification/solid/static_solver.h"

namespace lipofill::solid::testing {
namespace {

using verification::Case;
using verification::with_number;

double tip_deflection(int n, double nu) {
  const PointMap taper = [](const Eigen::Vector3d& s) {
    const double bottom = 44.0 * s[0];
    const double top = 44.0 + 16.0 * s[0];
    return Eigen::Vector3d(48.0 * s[0], bottom + (top - bottom) * s[1], s[2]);
  };
  const Box box{{n, n, 1}, {1, 1, 1}, true, taper};
  NodeSupports supports;
  supports.fixed.resize(box.n_nodes());
  Eigen::Matrix3Xd force = Eigen::Matrix3Xd::Zero(3, box.n_nodes());
  for_each_node(box, [&](int a, int i, int j, int) {
    supports.fixed[a] = {i == 0, i == 0, true};
    const bool end = j == 0 || j == n;
    if (i == n) force(1, a) = (end ? 0.5 : 1.0) / (2.0 * n);
  });
  Tissue tissue = Tissue::create(box.make(), {{1.0, nu, 1.0}}, supports, {}).value();
  return solve_linear(tissue, force)(1, box.node(n, n / 2, 0));
}

/// The corner's singularity keeps the order near 1.
void expect_tip(double nu, double expected) {
  Case cook({"solid/8c-cook", "Cook's membrane in plane strain",
             "Tip deflection of converged quadratic elements, E = F = 1; plain trilinear elements lock."});
  const std::string name = with_number("tip deflection, nu %g", nu);
  const std::vector<double> sizes = {8, 16, 32};
  std::vector<double> errors;
  for (const double n : sizes) errors.push_back(tip_deflection(static_cast<int>(n), nu) / expected - 1.0);
  EXPECT_LT(std::abs(errors[1]), 0.6 * std::abs(errors[0]));
  cook.record({name + ", 32 x 32", "1", expected, expected * (1.0 + errors[2]), 0.006});
  cook.record_series({name, "elements a side", sizes, errors, 1.0, -std::log2(0.6)});
}

TEST(CookMembrane, Nu045) {
  expect_tip(0.45, 19.583);
}
TEST(CookMembrane, Nu049) {
  expect_tip(0.49, 18.737);
}
TEST(CookMembrane, Nu04999) {
  expect_tip(0.4999, 18.512);
}

}  // namespace
}  // namespace lipofill::solid::testing
