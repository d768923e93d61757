// Elastica (verification case 9): a slender cantilever with a dead load across its tip, large
// rotations at small strains. The solid-shell in a strip one element wide and thick, nu = 0 so that
// EI is that of a beam. Reference: elliptic integrals.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/solid/box_mesh.h"
#include "tests/verification/record.h"
#include "tests/verification/solid/static_solver.h"

namespace lipofill::solid::testing {
namespace {

using verification::Case;
using verification::with_number;

constexpr double kLength = 0.1;
constexpr double kWidth = 0.01;
constexpr double kThickness = 0.002;
constexpr double kYoungsModulus = 1e5;
constexpr int kElements = 20;

struct Tip {
  double deflection = 0.0;  ///< w/L
  double shortening = 0.0;  ///< the chord is shorter by this share of L
};

Tip bend(double load, TissueLaw law) {
  const Box box{{kElements, 1, 1}, {kLength, kWidth, kThickness}};
  const double EI = kYoungsModulus * kWidth * std::pow(kThickness, 3) / 12.0;
  const double P = load * EI / (kLength * kLength);
  NodeSupports supports;
  supports.fixed.resize(box.n_nodes());
  Eigen::Matrix3Xd force = Eigen::Matrix3Xd::Zero(3, box.n_nodes());
  for_each_node(box, [&](int a, int i, int, int) {
    supports.fixed[a] = {i == 0, i == 0, i == 0};
    if (i == kElements) force(2, a) = 0.25 * P;
  });
  Tissue tissue = Tissue::create(box.make(), {{kYoungsModulus, 0.0, 1000.0, 0.0, law}}, supports, {}).value();
  const StaticState state = solve_static(tissue, force, 10);
  EXPECT_TRUE(state.converged);
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  for (const int k : {0, 1}) {
    const int a = box.node(kElements, 0, k);
    u += 0.5 * (state.x.col(a) - tissue.mesh().rest_positions.col(a));
  }
  return {u[2] / kLength, -u[0] / kLength};
}

void expect_tip(double load, double deflection, double shortening) {
  Case elastica({"solid/9a-elastica", "Elastica: a cantilever far past small rotations", "Elliptic integrals."});
  for (const TissueLaw law : {TissueLaw::kCorotational, TissueLaw::kNeoHookean}) {
    const Tip tip = bend(load, law);
    const std::string name =
        with_number(law == TissueLaw::kNeoHookean ? "at P L^2/EI = %g, neo-Hookean" : "at P L^2/EI = %g", load);
    elastica.record({"w/L " + name, "1", deflection, tip.deflection, 0.01});
    elastica.record({"shortening/L " + name, "1", shortening, tip.shortening, 0.01});
  }
}

TEST(Elastica, Load1) {
  expect_tip(1.0, 0.30172, 0.05643);
}
TEST(Elastica, Load2) {
  expect_tip(2.0, 0.49346, 0.16064);
}
TEST(Elastica, Load5) {
  expect_tip(5.0, 0.71379, 0.38763);
}
TEST(Elastica, Load10) {
  expect_tip(10.0, 0.81061, 0.55500);
}

}  // namespace
}  // namespace lipofill::solid::testing
