// Spreading on a Winkler wall, p = k (h - rest): the Barenblatt-Pattle solution, from its exact
// profile. A quarter of the plane, its two straight sides sealed: symmetry.

#include <algorithm>
#include <vector>

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ChartPoint;
using geometry::ScalarField;
using plan::FilmWallKind;

constexpr double kPi = 3.14159265358979323846;
constexpr double kStiffness = 1e6;  // [Pa/m]
constexpr double kViscosity = 10.0;
constexpr double kVolume = 1e-6;
const double kBeta = kStiffness / (12.0 * kViscosity);

double radius(double t) {
  return 0.893914 * std::pow(kBeta * kVolume * kVolume * kVolume * t, 0.125);
}

double centre_thickness(double t) {
  return 4.0 * kVolume / (3.0 * kPi * radius(t) * radius(t));
}

double thickness(double r, double t) {
  return centre_thickness(t) * std::cbrt(std::max(0.0, 1.0 - r * r / (radius(t) * radius(t))));
}

/// The profile at time t, sampled much more finely than by cells.
ScalarField sample_profile(double side, double t) {
  const int samples = 601;
  ScalarField field{samples, samples, {}};
  for (int j = 0; j < samples; ++j) {
    for (int i = 0; i < samples; ++i) field.values.push_back(thickness(side * std::hypot(i, j) / (samples - 1), t));
  }
  return field;
}

/// The film along one side of the quarter at the end.
struct Profile {
  double width = 0.0;     ///< a cell is so wide [m]
  std::vector<double> h;  ///< [m]

  double r(int i) const { return width * std::hypot(i + 0.5, 0.5); }
  /// Where the profile cubed, linear in r^2, reaches zero: from two cells, at 0.2 and at 0.75 of
  /// the radius `guess`.
  double front(double guess) const {
    const int a = static_cast<int>(0.2 * guess / width);
    const int b = static_cast<int>(0.75 * guess / width);
    const double fall = std::pow(h[a], 3) - std::pow(h[b], 3);
    return std::sqrt(r(a) * r(a) + std::pow(h[a], 3) / fall * (r(b) * r(b) - r(a) * r(a)));
  }
};

/// From the exact profile at `start` to `end`, with `cells_a_radius` cells a radius at the end.
Profile spread(double start, double end, int cells_a_radius, double step) {
  const int n = cells_a_radius * 5 / 4;
  const double side = 1.25 * radius(end);
  plan::SimulationSpec spec;
  spec.fat_viscosity = kViscosity;
  spec.films = {make_film(FilmWallKind::kWinkler, n, n)};
  spec.films[0].wall_stiffness = kStiffness;
  spec.films[0].rest_thickness = ScalarField::constant(0.0);
  spec.films[0].initial_thickness = sample_profile(side, start);
  for (int i = 0; i < std::min(n, 64); ++i)
    spec.probes.push_back({"p" + std::to_string(i), "film", ChartPoint{(i + 0.5) / n, 0.5 / n}});
  spec.step = step;
  spec.end = end - start;
  spec.settle_skin_speed = 0.0;
  auto simulation = make_simulation(make_bare_square(side, side), spec);
  run(*simulation);
  EXPECT_LT(simulation->report().film_volume_relative_error, 1e-10);
  return {side / n, simulation->report().probe_thickness};
}

Case barenblatt_case() {
  return Case({"film/3a-barenblatt", "A drop of 1 mL spreads on a Winkler wall",
               "Barenblatt-Pattle: R = 0.893914 (beta V^3 t)^(1/8), h^3 linear in r^2."});
}

void record_profile(Case& barenblatt, double t, const Profile& profile) {
  Curve curve{with_number("profile after %g s", t), "r [mm]", "h [mm]", {}, {}, {}};
  for (size_t i = 0; i < profile.h.size(); ++i) {
    const double r = profile.r(static_cast<int>(i));
    curve.x.push_back(1e3 * r);
    curve.measured.push_back(1e3 * profile.h[i]);
    curve.expected.push_back(1e3 * thickness(r, t));
  }
  barenblatt.record_curve(curve);
}

// k = 1e6 Pa/m, mu = 10, V = 1 mL: R(1 s) = 15.538 mm, R(10 s) = 20.720 mm.
TEST(Barenblatt, FrontAndHeightAfterTenSeconds) {
  Case barenblatt = barenblatt_case();
  EXPECT_NEAR(radius(1.0), 15.538e-3, 1e-6);
  const Profile profile = spread(1.0, 10.0, 60, 0.25);
  barenblatt.record({"front after 10 s, 60 cells a radius", "mm", 20.720, 1e3 * profile.front(radius(10.0)), 0.01});
  barenblatt.record(
      {"thickness in the middle after 10 s", "mm", 1e3 * centre_thickness(10.0), 1e3 * profile.h[0], 0.01});
  record_profile(barenblatt, 10.0, profile);
}

// R(100 s) = 27.631 mm.
TEST(Barenblatt, FrontAndHeightAfterHundredSeconds) {
  Case barenblatt = barenblatt_case();
  const Profile profile = spread(10.0, 100.0, 60, 2.5);
  barenblatt.record({"front after 100 s, 60 cells a radius", "mm", 27.631, 1e3 * profile.front(radius(100.0)), 0.01});
  barenblatt.record(
      {"thickness in the middle after 100 s", "mm", 1e3 * centre_thickness(100.0), 1e3 * profile.h[0], 0.01});
  record_profile(barenblatt, 100.0, profile);
}

/// Mean distance from the exact profile. The profile's slope is infinite at the front: first order.
TEST(Barenblatt, ProfileConvergesUnderRefinement) {
  Case barenblatt = barenblatt_case();
  const std::vector<double> cells = {8, 16, 32};
  std::vector<double> errors;
  for (const double n : cells) {
    const Profile profile = spread(1.0, 10.0, static_cast<int>(n), 2.0 / n);
    double error = 0.0;
    for (size_t i = 0; i < profile.h.size(); ++i) {
      error += std::abs(profile.h[i] - thickness(profile.r(static_cast<int>(i)), 10.0)) * profile.width;
    }
    errors.push_back(error / (centre_thickness(10.0) * radius(10.0)));
  }
  barenblatt.record_series({"profile after 10 s, in the mean", "cells a radius", cells, errors, 1.0, 0.8});
}

}  // namespace
}  // namespace lipofill::verification
