// Skin under tension at rest, lifted by a pressure. A strip clamped at both ends (cylindrical
// bending) obeys
//
//     D w'''' - T w'' = p,    T = sigma_0 t,   D = E t^3/(12 (1 - nu^2)),   w = w' = 0 at x = +-a
//     w = p/(2 T) (a^2 - x^2) - p a/(T l) (cosh(l a) - cosh(l x))/sinh(l a),   l^2 = T/D
//
// and a square sheet tends to the membrane's w0 = 0.0736713 p b^2/T as bending fades, by the width
// sqrt(D/T) of the zone along its edge where it bends.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "tests/unit/solid/box_mesh.h"
#include "tests/verification/record.h"
#include "tests/verification/solid/static_solver.h"

namespace lipofill::solid::testing {
namespace {

using verification::Case;
using verification::with_number;

constexpr double kLength = 0.1;
constexpr double kThickness = 1e-4;
constexpr double kYoungsModulus = 2e5;
constexpr double kNu = 0.45;
constexpr double kPressure = 1e-5;
const double kBending = kYoungsModulus * std::pow(kThickness, 3) / (12.0 * (1.0 - kNu * kNu));

Case prestress_case() {
  return Case({"solid/10-prestress", "Skin under tension, lifted by a pressure",
               "Closed form of D w'''' - T w'' = p for a clamped strip; series solution of the square membrane."});
}

/// Lift of the middle of a box under a pressure on its deep face. `holds(i, j)`: what of the column
/// there is held.
double solve_lift(const Box& box, double tension, const std::function<std::array<bool, 3>(int i, int j)>& holds) {
  NodeSupports supports;
  supports.fixed.resize(box.n_nodes());
  Eigen::Matrix3Xd force = Eigen::Matrix3Xd::Zero(3, box.n_nodes());
  const double cell = box.size[0] * box.size[1] / (box.n[0] * box.n[1]);
  for_each_node(box, [&](int a, int i, int j, int k) {
    supports.fixed[a] = holds(i, j);
    const double share = (i == 0 || i == box.n[0] ? 0.5 : 1.0) * (j == 0 || j == box.n[1] ? 0.5 : 1.0);
    if (k == 0) force(2, a) = kPressure * cell * share;
  });
  const ElasticMaterial material{kYoungsModulus, kNu, 1000.0, tension / kThickness};
  Tissue tissue = Tissue::create(box.make(), {material}, supports, {}).value();
  return solve_linear(tissue, force)(2, box.node(box.n[0] / 2, box.n[1] / 2, 0));
}

double strip_lift(double tension, int n) {
  const Box box{{n, 1, 1}, {kLength, kLength / n, kThickness}};
  return solve_lift(box, tension, [n](int i, int) -> std::array<bool, 3> {
    const bool end = i == 0 || i == n;
    return {end, true, end};
  });
}

double expected_strip_lift(double tension) {
  const double a = 0.5 * kLength;
  const double la = a * std::sqrt(tension / kBending);
  return kPressure * a * a / tension * (0.5 - std::tanh(0.5 * la) / la);  // (cosh s - 1)/sinh s = tanh(s/2)
}

double sheet_lift(double tension, int n) {
  const Box box{{n, n, 1}, {kLength, kLength, kThickness}};
  return solve_lift(box, tension, [n](int i, int j) -> std::array<bool, 3> {
    const bool rim = i == 0 || j == 0 || i == n || j == n;
    return {rim, rim, rim};
  });
}

/// Against the membrane's lift, for a width sqrt(D/T)/b of the bent zone along the edge.
double sheet_error(double bending_width, int n) {
  const double tension = kBending / std::pow(bending_width * kLength, 2);
  return sheet_lift(tension, n) / (0.0736713 * kPressure * kLength * kLength / tension) - 1.0;
}

TEST(Prestress, ClampedStrip) {
  Case strip = prestress_case();
  const std::vector<double> sizes = {16, 32, 64, 128};
  for (const double ratio : {0.01, 10.0, 100.0, 2500.0}) {
    const double tension = ratio * kBending / (kLength * kLength);
    const double expected = expected_strip_lift(tension);
    std::vector<double> errors;
    for (const double n : sizes) errors.push_back(strip_lift(tension, static_cast<int>(n)) / expected - 1.0);
    const std::string name = with_number("lift of the strip's middle, T L^2/D = %g", ratio);
    strip.record({name, "mm", 1e3 * expected, 1e3 * expected * (1.0 + errors.back()), 0.001});
    // Stiffer still, linear elements are exact at their nodes but for the bent ends: no order to
    // see.
    if (ratio <= 100.0) strip.record_series({name, "elements along the strip", sizes, errors});
  }
}

/// Without tension the closed form is that of the plate, p L^4/(384 D).
TEST(Prestress, ClosedFormTendsToThePlate) {
  const double plate = kPressure * std::pow(kLength, 4) / (384.0 * kBending);
  EXPECT_NEAR(expected_strip_lift(0.01 * kBending / (kLength * kLength)), plate, 1e-3 * plate);
}

TEST(Prestress, SquareMembrane) {
  constexpr int kElements = 40;
  Case membrane = prestress_case();
  const std::vector<double> bending_widths = {0.08, 0.04, 0.02, 0.01};  // sqrt(D/T)/b
  std::vector<double> errors;
  for (const double width : bending_widths) errors.push_back(sheet_error(width, kElements));
  membrane.record_series({"lift of the sheet's middle against the membrane's", "bending width over side",
                          bending_widths, errors, 1.0, 0.9});
  constexpr double kNoBending = 1e-4;
  membrane.record({"lift of the sheet's middle without bending over the membrane's", "1", 1.0,
                   1.0 + sheet_error(kNoBending, kElements), 0.003});
}

}  // namespace
}  // namespace lipofill::solid::testing
