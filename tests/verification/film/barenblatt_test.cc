// Spreading on a Winkler wall, p = k (h - rest): the Barenblatt-Pattle solution, from its exact profile.

#include <cstdio>
#include <vector>

#include "tests/verification/film/film_cases.h"

namespace lipofill::verification {
namespace {

using geometry::ChartPoint;
using geometry::ScalarField;
using simulation::FilmWallKind;

constexpr double kStiffness = 1e6;  // [Pa/m]
constexpr double kViscosity = 10.0;
constexpr double kVolume = 1e-6;
const double kBeta = kStiffness / (12.0 * kViscosity);

double radius(double t) {
  return 0.893914 * std::pow(kBeta * kVolume * kVolume * kVolume * t, 0.125);
}

double thickness(double r, double t) {
  const double pi = 3.14159265358979323846;
  const double front = radius(t);
  const double inside = 1.0 - r * r / (front * front);
  return inside <= 0.0 ? 0.0 : 4.0 * kVolume / (3.0 * pi * front * front) * std::cbrt(inside);
}

// verification.md case 3: k = 1e6 Pa/m, mu = 10, V = 1 mL: R(1 s) = 15.538 mm, R(10 s) = 20.720 mm. A quarter of the
// plane.
TEST(Barenblatt, FrontAndHeightAfterTenSeconds) {
  const double side = 0.026;
  const int n = 75;  // 60 cells a radius at the end
  const double pi = 3.14159265358979323846;
  simulation::SimulationSpec spec;
  spec.fat_viscosity = kViscosity;
  spec.films = {make_film(FilmWallKind::kWinkler, n, n)};
  spec.films[0].wall_stiffness = kStiffness;
  spec.films[0].rest_thickness = ScalarField::constant(0.0);
  // One sample a cell centre: the field is bilinear between n x n samples over the chart's corners, so it is sampled
  // finely.
  const int samples = 601;
  ScalarField start{samples, samples, {}};
  for (int j = 0; j < samples; ++j) {
    for (int i = 0; i < samples; ++i) {
      const double x = side * i / (samples - 1);
      const double y = side * j / (samples - 1);
      start.values.push_back(thickness(std::hypot(x, y), 1.0));
    }
  }
  spec.films[0].initial_thickness = start;
  for (int i = 0; i < n; ++i)
    spec.probes.push_back({"p" + std::to_string(i), "film", ChartPoint{(i + 0.5) / n, 0.5 / n}});
  spec.probes.resize(64);  // as many as a plan may have; they reach 22 mm
  spec.step = 0.25;
  spec.end = 9.0;
  spec.settle_skin_speed = 0.0;
  auto simulation = make_simulation(make_bare_square(side, side), spec);
  ASSERT_TRUE(simulation);
  run(*simulation);
  EXPECT_LT(simulation->report().film_volume_relative_error, 1e-10);
  const std::vector<double>& h = simulation->report().probe_thickness;
  // The front, from where the profile cubed, linear in r^2, would reach zero: h^3 = c (1 - r^2/R^2).
  const auto cubed = [&](int i) { return h[i] * h[i] * h[i]; };
  const auto square = [&](int i) {
    const double x = side * (i + 0.5) / n;
    return x * x + std::pow(0.5 * side / n, 2);
  };
  const int a = 10;
  const int b = 45;
  const double slope = (cubed(b) - cubed(a)) / (square(b) - square(a));
  const double front = std::sqrt(square(a) - cubed(a) / slope);
  const double centre = 4.0 * kVolume / (3.0 * pi * radius(10.0) * radius(10.0));
  std::printf("Barenblatt: front %.4f mm, expected %.4f; centre %.5f mm, expected %.5f\n", 1e3 * front,
              1e3 * radius(10.0), 1e3 * h[0], 1e3 * centre);
  EXPECT_NEAR(radius(10.0), 20.720e-3, 1e-6);
  EXPECT_NEAR(front, radius(10.0), 0.01 * radius(10.0));
  EXPECT_NEAR(h[0], centre, 0.01 * centre);
}

}  // namespace
}  // namespace lipofill::verification
