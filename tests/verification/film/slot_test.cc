// Reynolds flow between rigid plates, through the public simulation interface: fat goes in at one end of a film and out
// at the other.

#include <cstdio>

#include "tests/verification/film/film_cases.h"

namespace lipofill::verification {
namespace {

using geometry::ChartPoint;
using geometry::ScalarField;
using simulation::FilmWallKind;

/// Two probes inside a strip of n cells with a steady flux q [m2/s] along it; returns the pressure drop between them
/// [Pa].
double measure_drop(double length, const ScalarField& thickness, double viscosity, double q, int n, int first,
                    int last) {
  const double width = 4e-3;
  simulation::SimulationSpec spec;
  spec.fat_viscosity = viscosity;
  spec.films = {make_film(FilmWallKind::kRigid, n, 1)};
  spec.films[0].rest_thickness = thickness;
  const auto centre = [n](int cell) { return ChartPoint{(cell + 0.5) / n, 0.5}; };
  const double rate = q * width;
  spec.injections = {{"all", rate * 10.0, rate, 0.0, centre(0)}, {"all", -rate * 10.0, rate, 0.0, centre(n - 1)}};
  spec.probes = {{"in", "film", centre(first)}, {"out", "film", centre(last)}};
  spec.step = 0.1;
  spec.end = 1.0;
  spec.settle_skin_speed = 0.0;
  auto simulation = make_simulation(make_bare_square(length, width), spec);
  if (!simulation) return 0.0;
  run(*simulation);
  EXPECT_LT(simulation->report().film_volume_relative_error, 1e-10);
  return simulation->report().probe_pressure[0] - simulation->report().probe_pressure[1];
}

// verification.md case 1: h = 1 mm, mu = 10 Pa s, G = 1e4 Pa/m drives q = h^3 G / (12 mu) = 8.3333e-8 m2/s.
TEST(Slot, FluxOfAParallelSlot) {
  const int n = 40;
  const double length = 0.1;
  const double drop = measure_drop(length, ScalarField::constant(1e-3), 10.0, 8.333333333333333e-8, n, 5, 34);
  const double gradient = drop / (29.0 * length / n);
  std::printf("parallel slot: gradient %.6f Pa/m, expected 10000\n", gradient);
  EXPECT_NEAR(gradient, 1e4, 1e4 * 1e-6);
}

// verification.md case 1: the wedge 1 -> 0.5 mm over 50 mm, q = 1e-6 m2/s, mu = 10: dp between two stations is
// 6 mu q L (h1 + h2) / (h1 h2)^2 with the thicknesses there.
TEST(Slot, DropOfAWedgeConvergesToSecondOrder) {
  const double length = 0.05;
  const ScalarField wedge{2, 1, {1e-3, 0.5e-3}};
  const auto error = [&](int n) {
    const int first = n / 10;
    const int last = n - 1 - n / 10;
    const double drop = measure_drop(length, wedge, 10.0, 1e-6, n, first, last);
    const auto thickness = [&](int cell) { return 1e-3 - 0.5e-3 * (cell + 0.5) / n; };
    const double h1 = thickness(first);
    const double h2 = thickness(last);
    const double exact = 6.0 * 10.0 * 1e-6 * (last - first) * length / n * (h1 + h2) / (h1 * h1 * h2 * h2);
    return drop / exact - 1.0;
  };
  const double coarse = error(20);
  const double middle = error(40);
  const double fine = error(80);
  std::printf("wedge: relative errors %.3e %.3e %.3e, orders %.2f %.2f\n", coarse, middle, fine,
              observed_order(coarse, middle), observed_order(middle, fine));
  EXPECT_GT(observed_order(middle, fine), 1.8);
  EXPECT_LT(std::abs(fine), 2e-3);
}

// verification.md case 1: dp = 6 mu Q ln(r2/r1) / (pi h^3). The radial flow is that of one corner of a square with a
// source there and a sink spread evenly, against the potential of the same strengths (method of images) is avoided:
// probes near the source see ln r.
TEST(Slot, RadialSourceBetweenRigidPlates) {
  const int n = 81;
  const double side = 0.081;
  simulation::SimulationSpec spec;
  spec.fat_viscosity = 10.0;
  spec.films = {make_film(FilmWallKind::kRigid, n, n)};
  spec.films[0].rest_thickness = ScalarField::constant(1e-3);
  const double rate = 1e-7;
  spec.injections = {{"all", rate, rate, 0.0, ChartPoint{0.5, 0.5}}, {"all", -rate, rate, 0.0, std::nullopt}};
  const auto at = [&](double r) { return ChartPoint{0.5 + r / side, 0.5}; };
  spec.probes = {{"near", "film", at(5e-3)}, {"far", "film", at(15e-3)}};
  spec.step = 0.1;
  spec.end = 0.5;
  spec.settle_skin_speed = 0.0;
  auto simulation = make_simulation(make_bare_square(side, side), spec);
  ASSERT_TRUE(simulation);
  run(*simulation);
  const double drop = simulation->report().probe_pressure[0] - simulation->report().probe_pressure[1];
  // The even sink takes r^2 pi / A of the source within r: dp = 12 mu Q / (2 pi h^3) [ln(r2/r1) - pi (r2^2 - r1^2) / (2
  // A)], and the walls of the square enter at fourth order, (r/side)^4.
  const double pi = 3.14159265358979323846;
  const double r1 = 5e-3;
  const double r2 = 15e-3;
  const double exact =
      6.0 * 10.0 * rate / (pi * 1e-9) * (std::log(r2 / r1) - pi * (r2 * r2 - r1 * r1) / (2.0 * side * side));
  std::printf("radial source: drop %.3f Pa, expected %.3f\n", drop, exact);
  EXPECT_NEAR(drop, exact, 0.01 * exact);
}

}  // namespace
}  // namespace lipofill::verification
