// Reynolds flow between rigid plates, through the public simulation interface: fat goes in at one
// end of a film and out at the other.

#include <vector>

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ChartPoint;
using geometry::ScalarField;
using plan::FilmWallKind;

constexpr double kPi = 3.14159265358979323846;
constexpr double kViscosity = 10.0;

/// Two probes inside a strip of n cells with a steady flux q [m2/s] along it; returns the pressure
/// drop between them [Pa].
double measure_drop(double length, const ScalarField& thickness, double q, int n, int first, int last) {
  plan::SimulationSpec spec;
  spec.fat_viscosity = kViscosity;
  spec.step = 0.1;
  spec.end = 1.0;
  auto simulation = make_slot(spec, {length, thickness, n, first, last}, q);
  if (!simulation) return 0.0;
  run(*simulation);
  EXPECT_LT(simulation->report().film_volume_relative_error, 1e-10);
  return probed_drop(*simulation);
}

// h = 1 mm, mu = 10 Pa s, G = 1e4 Pa/m drives q = h^3 G / (12 mu) = 8.3333e-8 m2/s.
TEST(Slot, FluxOfAParallelSlot) {
  Case slot({"film/1a-slot", "Parallel slot", "Reynolds: q = h^3 G/(12 mu)."});
  const int n = 40;
  const double length = 0.1;
  const double drop = measure_drop(length, ScalarField::constant(1e-3), 8.333333333333333e-8, n, 5, 34);
  slot.record({"pressure gradient of 8.3333e-8 m2/s", "Pa/m", 1e4, drop / (29.0 * length / n), 1e-6});
}

/// Between two thicknesses a distance apart: 6 mu q L (h1 + h2)/(h1 h2)^2.
double wedge_drop(double q, double length, double h1, double h2) {
  return 6.0 * kViscosity * q * length * (h1 + h2) / (h1 * h1 * h2 * h2);
}

// The wedge 1 -> 0.5 mm over 50 mm, q = 1e-6 m2/s. Between its two ends: 18000 Pa. Probes lie in
// cells, so the drop is taken between the first and the last one, and what the closed form gives
// for the half cells beyond is added.
TEST(Slot, DropOfAWedgeConvergesToSecondOrder) {
  Case wedge({"film/1b-wedge", "Wedge 1 -> 0.5 mm over 50 mm", "Reynolds: dp = 6 mu q L (h1 + h2)/(h1 h2)^2."});
  const double length = 0.05;
  const double q = 1e-6;
  const auto measure = [&](int n) {
    const int first = n / 10;
    const int last = n - 1 - first;
    const double drop = measure_drop(length, {2, 1, {1e-3, 0.5e-3}}, q, n, first, last);
    const auto thickness = [&](double cells) { return 1e-3 - 0.5e-3 * cells / n; };
    const double outside = (first + 0.5) / n * length;
    return drop + wedge_drop(q, outside, 1e-3, thickness(first + 0.5)) +
           wedge_drop(q, outside, thickness(last + 0.5), 0.5e-3);
  };
  const std::vector<double> cells = {20, 40, 80};
  std::vector<double> errors;
  for (const double n : cells) errors.push_back(measure(static_cast<int>(n)) / 18000.0 - 1.0);
  wedge.record({"drop, 80 cells", "Pa", 18000.0, 18000.0 * (1.0 + errors.back()), 2e-3});
  wedge.record_series({"drop", "cells along the wedge", cells, errors, 2.0, 1.8});
}

/// Potential of a unit source in the middle of a sealed unit square whose sink is spread evenly, at
/// a distance r from it towards the middle of a side: -laplace G = delta - 1, by Fourier series
/// along the other direction.
double potential_in_square(double r) {
  double sum = 0.5 * r * r - 0.5 * r + 1.0 / 12.0;
  for (int k = 1; k <= 2000; ++k) {
    const double a = 2.0 * kPi * k;
    const double decay = (std::exp(-a * r) + std::exp(-a * (1.0 - r))) / (1.0 - std::exp(-a));
    sum += decay / a;
  }
  return sum;
}

// dp = 6 mu Q ln(r2/r1)/(pi h^3) of an unbounded film; Q = 1e-7 m3/s, r2/r1 = 10: 4397.61 Pa. In a
// square box, with an even sink, the closed form changes by what potential_in_square says; the
// box's share is taken off the measured drop.
TEST(Slot, RadialSourceBetweenRigidPlates) {
  Case source({"film/1c-radial-source", "Radial source between rigid plates, r2/r1 = 10",
               "dp = 6 mu Q ln(r2/r1)/(pi h^3); the square box around it by a Fourier series."});
  const double side = 0.081;
  const double rate = 1e-7;
  const double r1 = 3e-3;
  const double r2 = 30e-3;
  const double unbounded = 6.0 * kViscosity * rate * std::log(r2 / r1) / (kPi * 1e-9);
  const double boxed =
      12.0 * kViscosity * rate / 1e-9 * (potential_in_square(r1 / side) - potential_in_square(r2 / side));
  const auto measure = [&](int n) {
    plan::SimulationSpec spec;
    spec.fat_viscosity = kViscosity;
    spec.films = {make_film(FilmWallKind::kRigid, n, n)};
    spec.films[0].rest_thickness = ScalarField::constant(1e-3);
    spec.injections = {{"all", rate, rate, 0.0, ChartPoint{0.5, 0.5}}, {"all", -rate, rate, 0.0, std::nullopt}};
    const auto at = [&](double r) { return ChartPoint{0.5, 0.5 + r / side}; };
    spec.probes = {{"near", "film", at(r1)}, {"far", "film", at(r2)}};
    spec.step = 0.1;
    spec.end = 0.2;
    spec.settle_skin_speed = 0.0;
    auto simulation = make_simulation(make_bare_square(side, side), spec);
    run(*simulation);
    return simulation->report().probe_pressure[0] - simulation->report().probe_pressure[1] + unbounded - boxed;
  };
  EXPECT_NEAR(unbounded, 4397.61, 0.01);
  const std::vector<double> cells = {27, 81};
  std::vector<double> errors;
  for (const double n : cells) errors.push_back(measure(static_cast<int>(n)) / unbounded - 1.0);
  source.record({"drop, 81 x 81 cells", "Pa", 4397.61, unbounded * (1.0 + errors.back()), 5e-3});
  source.record_series({"drop", "cells a side", cells, errors, 2.0, 1.8});
}

}  // namespace
}  // namespace lipofill::verification
