// Fat that is not Newtonian between walls, through the public simulation interface.

#include <algorithm>
#include <vector>

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ChartPoint;
using geometry::ScalarField;
using plan::FilmWallKind;

/// Pressure gradient along a slot of 1 mm when q [m2/s] flows through it [Pa/m].
double measure_gradient(const plan::SimulationSpec& fat, double q) {
  plan::SimulationSpec spec = fat;
  spec.step = 0.1;
  spec.end = 0.5;
  auto simulation = make_slot(spec, {}, q);
  if (!simulation) return 0.0;
  run(*simulation);
  EXPECT_LT(simulation->report().film_volume_relative_error, 1e-10);
  return probed_drop(*simulation) / (10.0 * 0.05 / 20);
}

const char kSlotReference[] =
    "plane Poiseuille flow: Bingham factor 1 - 3/2 B + 1/2 B^3, B = 2 tau_y/(h G); power law q = h^2/2 n/(2n+1) "
    "(h G/(2K))^(1/n)";

// verification.md case 2: tau_y = 2 Pa on the slot of case 1 (mu = 10, G = 1e4 Pa/m) leaves 0.4320
// of its flux.
TEST(NonNewtonianSlot, BinghamFlux) {
  Case record({"film/2-bingham-and-power-law", "Bingham and power-law fat in a slot", kSlotReference});
  plan::SimulationSpec fat;
  fat.fat_viscosity = 10.0;
  fat.fat_yield_stress = 2.0;
  const double flux = 0.4320 * 8.333333333333333e-8;
  record.record(
      {"Bingham gradient that drives 0.4320 of the Newtonian flux", "Pa/m", 1e4, measure_gradient(fat, flux), 1e-6});
}

// verification.md case 2: n = 0.5, K = 10 at G = 1e4 Pa/m: q = 3.125e-8 m2/s.
TEST(NonNewtonianSlot, PowerLawFlux) {
  Case record({"film/2-bingham-and-power-law", "Bingham and power-law fat in a slot", kSlotReference});
  plan::SimulationSpec fat;
  fat.fat_viscosity = 10.0;
  fat.fat_flow_index = 0.5;
  record.record({"power-law gradient that drives 3.125e-8 m2/s", "Pa/m", 1e4, measure_gradient(fat, 3.125e-8), 1e-6});
}

// Coleman fat as it is: n = 0.28, K = 48, tau_y = 7 Pa.
TEST(NonNewtonianSlot, HerschelBulkleyFlux) {
  Case record({"film/2-bingham-and-power-law", "Bingham and power-law fat in a slot", kSlotReference});
  plan::SimulationSpec fat;
  fat.fat_viscosity = 48.0;
  fat.fat_flow_index = 0.28;
  fat.fat_yield_stress = 7.0;
  const double h = 1e-3;
  const double n = 0.28;
  const double gradient = 2e5;
  const double wall_stress = 0.5 * h * gradient;
  const double phi = 7.0 / wall_stress;
  const double flux = 0.5 * h * h * std::pow(wall_stress / 48.0, 1.0 / n) * n / (2.0 * n + 1.0) *
                      std::pow(1.0 - phi, 1.0 / n + 1.0) * (1.0 + n / (n + 1.0) * phi);
  record.record({"Herschel-Bulkley gradient of Coleman fat", "Pa/m", gradient, measure_gradient(fat, flux), 1e-6});
}

/// A ridge of 2 mm across half of a channel of n cells on a Winkler wall, p = k h.
plan::SimulationSpec make_ridge(int n, double stiffness, double end) {
  plan::SimulationSpec spec;
  spec.fat_viscosity = 10.0;
  spec.films = {make_film(FilmWallKind::kWinkler, n, 1)};
  spec.films[0].wall_stiffness = stiffness;
  spec.films[0].rest_thickness = ScalarField::constant(0.0);
  ScalarField start{2 * n + 1, 1, {}};
  for (int i = 0; i <= 2 * n; ++i) start.values.push_back(i < n ? 2e-3 : i == n ? 1e-3 : 0.0);
  spec.films[0].initial_thickness = start;
  for (int i = 0; i < n; ++i) {
    spec.probes.push_back({"p" + std::to_string(i), "film", ChartPoint{(i + 0.5) / n, 0.5}});
  }
  spec.step = 0.05;
  spec.max_step = 20.0;
  spec.error_tolerance = 1e-6;
  spec.end = end;
  spec.settle_skin_speed = 0.0;
  return spec;
}

// A Bingham ridge that collapses on a Winkler wall stops where the wall stress is the yield stress
// everywhere, h/2 k |h'| = tau_y: h^2 falls linearly, by 4 tau_y/k a metre. A Newtonian one spreads
// on.
TEST(YieldStressDeposit, StopsWhereTheWallStressIsTheYieldStress) {
  Case record({"fat/1-arrested-ridge", "A yield-stress deposit stays, a Newtonian one spreads",
               "arrest: tau_y = h/2 |dp/dx| and p = k h give h^2 = (4 tau_y/k)(front - x); volume fixes the front"});
  const double length = 0.04;
  const double stiffness = 1e6;
  const double yield_stress = 20.0;
  const double volume_per_width = 2e-3 * 0.5 * length;
  const double fall = 4.0 * yield_stress / stiffness;  // h^2 falls by this a metre
  // Area of sqrt(fall (R - x)) over 0 < x < R is 2/3 sqrt(fall) R^(3/2).
  const double front = std::pow(1.5 * volume_per_width / std::sqrt(fall), 2.0 / 3.0);
  ASSERT_LT(front, length);
  const int n = 64;
  plan::SimulationSpec spec = make_ridge(n, stiffness, 4000.0);
  spec.fat_yield_stress = yield_stress;
  auto arrested = make_simulation(make_bare_square(length, 4e-3), spec);
  ASSERT_TRUE(arrested);
  run(*arrested);
  EXPECT_LT(arrested->report().film_volume_relative_error, 1e-10);
  std::vector<double> x, shape, closed, newtonian;
  double error = 0.0;
  for (int i = 0; i < n; ++i) {
    x.push_back(1e3 * length * (i + 0.5) / n);
    shape.push_back(1e3 * arrested->report().probe_thickness[i]);
    closed.push_back(1e3 * std::sqrt(std::max(0.0, fall * (front - 1e-3 * x.back()))));
    error += std::abs(shape.back() - closed.back()) / n / 2.0;
  }
  record.record(
      {"mean thickness error of the arrested ridge over its first height", "1", 0.003, error, 0.0, Bound::kAtMost});
  auto spreading = make_simulation(make_bare_square(length, 4e-3), make_ridge(n, stiffness, 4000.0));
  ASSERT_TRUE(spreading);
  run(*spreading);
  for (int i = 0; i < n; ++i) newtonian.push_back(1e3 * spreading->report().probe_thickness[i]);
  const auto [lowest, highest] = std::minmax_element(newtonian.begin(), newtonian.end());
  record.record({"Newtonian ridge after 4000 s: lowest over highest thickness", "1", 0.9, *lowest / *highest, 0.0,
                 Bound::kAtLeast});
  record.record_curve(
      {"Bingham ridge at rest", "x [mm]", "thickness [mm]", x, shape, closed, false, "measured", "arrest"});
  record.record_curve({"The same and a Newtonian ridge", "x [mm]", "thickness [mm]", x, shape, newtonian, false,
                       "Bingham", "Newtonian"});
}

// Below the yield stress nothing creeps: a ridge too low to flow keeps its volumes and its pressure
// gradient.
TEST(YieldStressDeposit, UnyieldedFatHoldsItsPressureGradient) {
  Case record({"fat/2-unyielded", "Unyielded fat holds its pressure gradient",
               "wall stress h/2 |dp/dx| below tau_y: the flux is zero, whatever the time"});
  const int n = 24;
  const double length = 0.04;
  plan::SimulationSpec spec = make_ridge(n, 1e5, 2e4);
  ScalarField start{2, 1, {1.2e-3, 0.8e-3}};
  spec.films[0].initial_thickness = start;
  spec.fat_yield_stress = 1.0;  // wall stress of the slope: 1.2e-3/2 * 1e5 * 0.01 = 0.6 Pa at most
  spec.max_step = 60.0;
  auto simulation = make_simulation(make_bare_square(length, 4e-3), spec);
  ASSERT_TRUE(simulation);
  const std::vector<double> thickness = simulation->report().probe_thickness;
  const std::vector<double> pressure = simulation->report().probe_pressure;
  run(*simulation);
  double moved = 0.0, changed = 0.0;
  for (int i = 0; i < n; ++i) {
    moved = std::max(moved, std::abs(simulation->report().probe_thickness[i] / thickness[i] - 1.0));
    changed = std::max(changed, std::abs(simulation->report().probe_pressure[i] / pressure[i] - 1.0));
  }
  record.record({"relative change of thickness after 2e4 s", "1", 1e-9, moved, 0.0, Bound::kAtMost});
  record.record({"relative change of pressure after 2e4 s", "1", 1e-9, changed, 0.0, Bound::kAtMost});
}

// Flow of a Maxwell fluid started at once in a slot: dp/dx = 12 mu q/h^3 (1 - exp(-t/lambda)),
// lambda = mu/G.
TEST(MaxwellFat, StressGrowsWithTheRelaxationTime) {
  Case record({"fat/3-maxwell", "Start-up of a Maxwell fluid at constant flux",
               "tau + lambda dtau/dt = mu rate at constant rate: 1 - exp(-t/lambda), lambda = mu/G"});
  const double viscosity = 15.0;
  const double modulus = 70.0;
  const double relaxation_time = viscosity / modulus;
  const int n = 10;
  const double length = 0.05;
  const double q = 1e-8;
  const double thickness = 1e-3;
  std::vector<double> errors, steps;
  std::vector<double> time, measured, expected;
  for (const double step : {0.02, 0.01, 0.005}) {
    plan::SimulationSpec spec;
    spec.fat_viscosity = viscosity;
    spec.fat_shear_modulus = modulus;
    spec.step = step;
    spec.end = 0.6;
    auto simulation = make_slot(spec, {length, ScalarField::constant(thickness), n, 2, 7}, q);
    ASSERT_TRUE(simulation);
    const double steady = 12.0 * viscosity * q / std::pow(thickness, 3);
    double error = 0.0;
    time.clear(), measured.clear(), expected.clear();
    while (simulation->phase() == simulation::Phase::kRunning) {
      simulation->advance_step();
      const auto& report = simulation->report();
      time.push_back(report.time);
      measured.push_back(probed_drop(*simulation) / (5.0 * length / n));
      expected.push_back(steady * (1.0 - std::exp(-report.time / relaxation_time)));
      error = std::max(error, std::abs(measured.back() - expected.back()) / steady);
    }
    errors.push_back(error);
    steps.push_back(1e3 * step);
  }
  record.record_series({"largest gradient error over the steady gradient", "step [ms]", steps, errors, 1.0, 0.9});
  record.record(
      {"largest gradient error over the steady gradient at 5 ms", "1", 0.01, errors.back(), 0.0, Bound::kAtMost});
  record.record_curve({"pressure gradient", "time [s]", "gradient [Pa/m]", time, measured, expected});
}

// Gravity along a slot that is shut at both ends: the fat stands still and its pressure is
// hydrostatic; let through, it falls at q = rho g h^3/(12 mu).
TEST(GravityInASlot, DrivesTheFluxOfItsWeight) {
  Case record({"fat/4-gravity", "Gravity along a film",
               "hydrostatic pressure rho g L in a shut slot; q = rho g h^3/(12 mu) where the pressure is level"});
  const int n = 20;
  const double length = 0.05;
  const double h = 2e-3;
  const double q = 920.0 * 9.81 * h * h * h / (12.0 * 15.0);
  const auto drop = [&](double flux) {
    plan::SimulationSpec spec;
    spec.gravity = {9.81, 0.0, 0.0};
    spec.step = 0.1;
    spec.end = 1.0;
    auto simulation = make_slot(spec, {length, ScalarField::constant(h), n, 4, 14}, flux);
    if (!simulation) return 0.0;
    run(*simulation);
    return -probed_drop(*simulation);
  };
  const double hydrostatic = 920.0 * 9.81 * 10.0 * length / n;
  record.record({"hydrostatic difference over 25 mm", "Pa", hydrostatic, drop(0.0), 1e-9});
  record.record({"pressure difference left when fat falls freely, over the hydrostatic one", "1", 1e-6,
                 drop(q) / hydrostatic, 0.0, Bound::kAtMost});
}

}  // namespace
}  // namespace lipofill::verification
