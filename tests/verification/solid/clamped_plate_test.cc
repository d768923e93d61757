// Clamped plates under uniform pressure, one element through the thickness (verification case 6),
// and the first eigenfrequency of the square one. References: Kirchhoff's plate, w0 = 0.00126532 p
// b^4 / D (square), p a^4 / (64 D) (circle), f1 = 35.9852 / (2 pi b^2) sqrt(D / (rho t)); they are
// approached as the plate gets thin.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/solid/box_mesh.h"
#include "tests/verification/record.h"
#include "tests/verification/solid/block_mesh.h"
#include "tests/verification/solid/static_solver.h"

namespace lipofill::solid::testing {
namespace {

using verification::Bound;
using verification::Case;
using verification::with_number;

constexpr double kYoungsModulus = 200e3;
constexpr double kDensity = 1100.0;
constexpr double kPressure = 10.0;

struct Plate {
  int n = 20;
  double side = 0.1;  ///< the square has this side, the circle this radius
  double thickness = 0.002;
  double nu = 0.45;
  double distortion = 0.0;
  bool stacked = false;
  TissueLaw law = TissueLaw::kCorotational;
};

double bending_stiffness(const Plate& plate) {
  return kYoungsModulus * std::pow(plate.thickness, 3) / (12.0 * (1.0 - plate.nu * plate.nu));
}

Box box_of(const Plate& plate) {
  return {{plate.n, plate.n, 1}, {plate.side, plate.side, plate.thickness}, plate.stacked};
}

Tissue make_square(const Plate& plate) {
  const Box box = box_of(plate);
  HexMesh mesh = box.make();
  distort_in_plane(box, plate.distortion, 1, mesh);
  for (int k = 0; k < 2; ++k) {  // the centre's node stays where the deflection is read
    mesh.rest_positions.col(box.node(plate.n / 2, plate.n / 2, k)).head<2>().setConstant(plate.side / 2);
  }
  NodeSupports supports;
  supports.fixed.resize(box.n_nodes());
  for_each_node(box, [&](int a, int i, int j, int) {
    const bool rim = i == 0 || j == 0 || i == plate.n || j == plate.n;
    supports.fixed[a] = {rim, rim, rim};
  });
  return Tissue::create(std::move(mesh), {{kYoungsModulus, plate.nu, kDensity, 0.0, plate.law}}, supports, {}).value();
}

/// Displacements under pressure from below.
Eigen::Matrix3Xd inflate(Tissue& tissue) {
  const auto everywhere = [](int) { return true; };
  return solve_linear(tissue, compute_pressure_force(tissue.mesh(), everywhere, true, kPressure));
}

double kirchhoff_deflection(const Plate& plate) {
  return 0.00126532 * kPressure * std::pow(plate.side, 4) / bending_stiffness(plate);
}

/// Of the centre, the mean of the two faces, over Kirchhoff's.
double relative_deflection(const Plate& plate) {
  Tissue tissue = make_square(plate);
  const Eigen::Matrix3Xd u = inflate(tissue);
  const Box box = box_of(plate);
  const int centre = plate.n / 2;
  const double w = 0.5 * (u(2, box.node(centre, centre, 0)) + u(2, box.node(centre, centre, 1)));
  return w / kirchhoff_deflection(plate);
}

Case square_case() {
  return Case({"solid/6a-square", "Clamped square plate under pressure, one element thick",
               "Kirchhoff, w0 = 0.00126532 p b^4/D, approached as t/b -> 0; shear adds 0.8 % at t/b = 1/50 (figures of "
               "an independent prototype)."});
}

std::string describe(const Plate& plate) {
  std::string text = with_number("%g", plate.n) + with_number(" x %g", plate.n) +
                     with_number(", t/b = 1/%g", std::round(plate.side / plate.thickness));
  if (plate.nu != 0.45) text += with_number(", nu %g", plate.nu);
  if (plate.distortion != 0.0) text += with_number(", distorted by %g %%", 100.0 * plate.distortion);
  if (plate.law == TissueLaw::kNeoHookean) text += ", neo-Hookean";
  return text + (plate.stacked ? ", incompatible modes" : "");
}

/// Asserts that the deflection is Kirchhoff's but for `error`.
void expect_deflection(Case& square, const Plate& plate, double error, double tolerance) {
  square.record(
      {"w0/Kirchhoff, " + describe(plate), "1", 1.0 + error, relative_deflection(plate), tolerance, Bound::kAbsolute});
}

TEST(ClampedSquare, OneElementThickNeitherLocksNorDrifts) {
  Case square = square_case();
  expect_deflection(square, {.n = 20}, 0.0067, 0.0005);
  expect_deflection(square, {.n = 40}, 0.0080, 0.0005);
}

TEST(ClampedSquare, DistortedMeshChangesLittle) {
  Case square = square_case();
  expect_deflection(square, {.n = 20, .distortion = 0.2}, 0.0050, 0.002);
  expect_deflection(square, {.n = 40, .distortion = 0.2}, 0.0078, 0.001);
}

TEST(ClampedSquare, NearlyIncompressible) {
  Case square = square_case();
  expect_deflection(square, {.n = 20, .nu = 0.499}, 0.0, 0.012);
  expect_deflection(square, {.n = 40, .nu = 0.499}, 0.0, 0.012);
  expect_deflection(square, {.n = 40, .nu = 0.49999}, 0.0, 0.012);
}

TEST(ClampedSquare, IncompatibleModesOnARegularMesh) {
  Case square = square_case();
  expect_deflection(square, {.n = 20, .stacked = true}, -0.0005, 0.0005);
  expect_deflection(square, {.n = 40, .stacked = true}, 0.0068, 0.0005);
}

/// The neo-Hookean solid-shell at small strain, its stabilisation in closed form.
TEST(ClampedSquare, NeoHookeanNeitherLocksNorDrifts) {
  Case square = square_case();
  for (const double nu : {0.45, 0.4999}) {
    expect_deflection(square, {.n = 20, .nu = nu, .law = TissueLaw::kNeoHookean}, 0.0, 0.012);
    expect_deflection(square, {.n = 40, .nu = nu, .law = TissueLaw::kNeoHookean}, 0.0, 0.012);
    expect_deflection(square, {.n = 40, .nu = nu, .distortion = 0.2, .law = TissueLaw::kNeoHookean}, 0.0, 0.012);
  }
}

/// What is left of the error at fixed mesh is shear, of order (t/b)^2.
TEST(ClampedSquare, ApproachesKirchhoffAsItThins) {
  Case square = square_case();
  const auto at = [](double thickness) { return relative_deflection({.n = 40, .thickness = thickness}); };
  const double limit = at(0.0002);
  square.record({"w0/Kirchhoff, 40 x 40, t/b = 1/500", "1", 1.0, limit, 0.001});
  const std::vector<double> ratios = {1.0 / 12.5, 1.0 / 25.0, 1.0 / 50.0};
  std::vector<double> shear;
  for (const double ratio : ratios) shear.push_back(at(0.1 * ratio) - limit);
  const double order = square.record_series({"w0 less its thin limit", "t/b", ratios, shear, 2.0, 1.8});
  EXPECT_LE(order, 2.2);
}

TEST(ClampedSquare, ConvergesToKirchhoffUnderRefinement) {
  Case square = square_case();
  const std::vector<double> sizes = {10, 20, 40};
  std::vector<double> errors;
  for (const double n : sizes) {
    errors.push_back(relative_deflection({.n = static_cast<int>(n), .thickness = 0.00005}) - 1.0);
  }
  square.record_series({"w0 at t/b = 1/2000", "elements a side", sizes, errors, 2.0, 1.8});
}

TEST(ClampedSquare, FirstFrequency) {
  Case square({"solid/9c-frequency", "First frequency of the clamped square plate",
               "Kirchhoff: f1 = 35.9852/(2 pi b^2) sqrt(D/(rho t)), 31.2045 Hz at t = 2 mm, b = 40 mm."});
  const Plate plate{.n = 40, .side = 0.04, .thickness = 0.0002};
  Tissue tissue = make_square(plate);
  const double expected = 31.2045 * plate.thickness / 0.002;  // proportional to t
  square.record({"f1, t/b = 1/200", "Hz", expected, compute_first_frequency(tissue), 0.002});
}

/// At t/b = 1/20 shear and rotary inertia lower it; a plate of first-order shear theory gives about
/// 3 % for nu = 0.45.
TEST(ClampedSquare, FirstFrequencyOfTheThickPlateIsBelowKirchhoffs) {
  Case square({"solid/9c-frequency", "First frequency of the clamped square plate",
               "Kirchhoff: f1 = 35.9852/(2 pi b^2) sqrt(D/(rho t)), 31.2045 Hz at t = 2 mm, b = 40 mm."});
  Tissue tissue = make_square({.n = 40, .side = 0.04});
  const double f1 = compute_first_frequency(tissue);
  square.record({"f1, t/b = 1/20: shear lowers it", "Hz", 31.2045, f1, 0.045});
  EXPECT_LT(f1, 31.2045);
}

// The circle: a quarter of three blocks, round a square in the middle, with rollers on its two
// straight sides.

Eigen::Vector2d mix(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double s) {
  return (1.0 - s) * a + s * b;
}

HexMesh make_quarter_disc(const Plate& plate) {
  const Eigen::Vector2d right(0.5, 0.0);
  const Eigen::Vector2d corner(0.4, 0.4);
  const Eigen::Vector2d top(0.0, 0.5);
  const auto lift = [&plate](const Eigen::Vector2d& p, double zeta) {
    return Eigen::Vector3d(plate.side * p[0], plate.side * p[1], plate.thickness * zeta);
  };
  const auto arc = [](double quarter) -> Eigen::Vector2d {
    return {std::cos(0.5 * M_PI * quarter), std::sin(0.5 * M_PI * quarter)};
  };
  BlockMesh blocks(1e-3 * plate.thickness);
  const std::array<int, 3> n = {plate.n, plate.n, 1};
  blocks.add_block(n, plate.stacked, [&](const Eigen::Vector3d& s) {
    return lift(mix(mix({0, 0}, right, s[0]), mix(top, corner, s[0]), s[1]), s[2]);
  });
  blocks.add_block(n, plate.stacked, [&](const Eigen::Vector3d& s) {
    return lift(mix(mix(right, corner, s[1]), arc(0.5 * s[1]), s[0]), s[2]);
  });
  blocks.add_block(n, plate.stacked, [&](const Eigen::Vector3d& s) {
    return lift(mix(mix(corner, top, s[1]), arc(0.5 + 0.5 * s[1]), s[0]), s[2]);
  });
  return blocks.finish();
}

struct DiscResult {
  double deflection = 0.0;  ///< the centre moves this far [m]
  double volume = 0.0;      ///< swept by the whole disc [m3]
};

DiscResult inflate_disc(const Plate& plate) {
  const HexMesh mesh = make_quarter_disc(plate);
  NodeSupports supports;
  for (int a = 0; a < mesh.n_nodes(); ++a) {
    const Eigen::Vector3d X = mesh.rest_positions.col(a);
    const bool rim = X.head<2>().norm() > plate.side * (1.0 - 1e-9);
    supports.fixed.push_back({rim || X[0] < 1e-9 * plate.side, rim || X[1] < 1e-9 * plate.side, rim});
  }
  Tissue tissue = Tissue::create(mesh, {{kYoungsModulus, plate.nu, kDensity}}, supports, {}).value();
  const auto everywhere = [](int) { return true; };
  const Eigen::Matrix3Xd force = compute_pressure_force(mesh, everywhere, true, kPressure);
  const Eigen::Matrix3Xd u = solve_linear(tissue, force);
  DiscResult result;
  for (int a = 0; a < mesh.n_nodes(); ++a) {
    if (mesh.rest_positions.col(a).head<2>().norm() < 1e-9 * plate.side) result.deflection += 0.5 * u(2, a);
  }
  result.volume = 4.0 * u.cwiseProduct(force).sum() / kPressure;  // work of a unit pressure
  return result;
}

Case circle_case() {
  return Case({"solid/6b-circle", "Clamped circular plate under pressure, one element thick",
               "Kirchhoff: w0 = p a^4/(64 D), V = pi p a^6/(192 D), approached as t/a -> 0."});
}

/// Deflection and volume over Kirchhoff's.
DiscResult relative_disc(const Plate& plate) {
  DiscResult result = inflate_disc(plate);
  result.deflection *= 64.0 * bending_stiffness(plate) / (kPressure * std::pow(plate.side, 4));
  result.volume *= 192.0 * bending_stiffness(plate) / (M_PI * kPressure * std::pow(plate.side, 6));
  return result;
}

TEST(ClampedCircle, ThinPlateIsKirchhoffs) {
  Case circle = circle_case();
  const DiscResult result = relative_disc({.n = 16, .side = 0.02, .thickness = 0.0001});
  circle.record({"w0/Kirchhoff, t/a = 1/200", "1", 1.0, result.deflection, 0.005});
  circle.record({"V/Kirchhoff, t/a = 1/200", "1", 1.0, result.volume, 0.005});
}

TEST(ClampedCircle, ApproachesKirchhoffAsItThins) {
  Case circle = circle_case();
  const double limit = relative_disc({.n = 16, .side = 0.02, .thickness = 0.00005}).deflection;
  const std::vector<double> ratios = {0.1, 0.05, 0.025};
  std::vector<double> shear;
  for (const double ratio : ratios) {
    shear.push_back(relative_disc({.n = 16, .side = 0.02, .thickness = 0.02 * ratio}).deflection - limit);
  }
  circle.record_series({"w0 less its thin limit", "t/a", ratios, shear, 2.0, 1.8});
}

/// Case 6 itself, t/a = 1/10: first-order shear theory adds p a^2 / (4 kappa G t), kappa = 5/6, to
/// Kirchhoff's 0.149531 mm.
TEST(ClampedCircle, ThickPlateHasItsShearDeflection) {
  const Plate plate{.n = 16, .side = 0.02};
  const double G = kYoungsModulus / (2.0 * (1.0 + plate.nu));
  const double shear = kPressure * plate.side * plate.side / (4.0 * (5.0 / 6.0) * G * plate.thickness);
  Case circle = circle_case();
  circle.record(
      {"w0 with its shear, t/a = 1/10", "mm", 0.149531 + 1e3 * shear, 1e3 * inflate_disc(plate).deflection, 0.015});
}

}  // namespace
}  // namespace lipofill::solid::testing
