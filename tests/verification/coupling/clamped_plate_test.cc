// A film under a clamped plate at rest, through the public simulation interface.

#include <cstdio>

#include "tests/verification/film/film_cases.h"

namespace lipofill::verification {
namespace {

using geometry::ScalarField;

/// A clamped square plate of side b over rigid bone with a film in between.
std::shared_ptr<const simulation::FaceModel> make_plate(double side, double thickness, int n, double youngs_modulus) {
  simulation::FaceModelSpec spec;
  spec.region = geometry::SquareSpec{side, side};
  spec.n_xi = spec.n_eta = n;
  spec.layers = {{"plate", {ScalarField::constant(thickness), 1}, {youngs_modulus, 0.45, 1100.0}}};
  auto model = simulation::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return *model;
}

simulation::SimulationSpec make_plan(int cells, double volume) {
  simulation::SimulationSpec spec;
  spec.films = {make_film(simulation::FilmWallKind::kTissue, cells, cells)};
  spec.films[0].below_layer = "plate";
  spec.films[0].rest_thickness = ScalarField::constant(3e-3);
  spec.injections = {{"all", volume, volume / 0.1, 0.0, std::nullopt}};
  spec.fat_viscosity = 0.1;
  spec.step = 0.02;
  spec.max_step = 5.0;
  spec.end = 5000.0;
  spec.settle_skin_speed = 1e-11;
  return spec;
}

// verification.md case 6, square: V = 3.89120e-4 p b^6 / D, w0 = 0.00126532 p b^4 / D. At a small load, t/b = 1/80.
TEST(InflatedPlate, PressureOfAnInjectedVolumeIsThatOfKirchhoff) {
  const double side = 0.04;
  const double thickness = 0.5e-3;
  const double youngs_modulus = 2e5;
  const double rigidity = youngs_modulus * std::pow(thickness, 3) / (12.0 * (1.0 - 0.45 * 0.45));
  const double pressure = 0.01;
  const double volume = 3.89120e-4 * pressure * std::pow(side, 6) / rigidity;
  const double deflection = 0.00126532 * pressure * std::pow(side, 4) / rigidity;
  const auto errors = [&](int n) {
    auto simulation = make_simulation(make_plate(side, thickness, n, youngs_modulus), make_plan(n / 2, volume));
    run(*simulation);
    EXPECT_LT(simulation->report().gap_volume_relative_error, 1e-4);
    EXPECT_LT(simulation->report().film_volume_relative_error, 1e-10);
    const double p = simulation->report().mean_pressure;
    EXPECT_NEAR(simulation->report().max_pressure, simulation->report().min_pressure, 1e-3 * p);
    return std::array<double, 2>{p / pressure - 1.0, simulation->report().skin_max_displacement / deflection - 1.0};
  };
  const auto coarse = errors(16);
  const auto fine = errors(32);
  std::printf("inflated plate: pressure error %.3f %% then %.3f %%, deflection %.3f %% then %.3f %%\n", 100 * coarse[0],
              100 * fine[0], 100 * coarse[1], 100 * fine[1]);
  EXPECT_LT(std::abs(fine[0]), 0.02);
  EXPECT_LT(std::abs(fine[1]), 0.01);
  EXPECT_LT(std::abs(fine[0]), std::abs(coarse[0]));
}

// verification.md case 5: a sinusoid of wavenumber k under an elastic layer of thickness H, symmetry on the sides,
// decays at sigma = h0^3 k^2 S / (12 mu), S = E k / (2 (1 - nu^2)) (sinh^2 x - x^2) / (sinh x cosh x + x), x = k H.
TEST(SinusoidUnderElasticLayer, DecaysAtTheClosedRate) {
  const double wavelength = 0.04;
  const double height = 0.01;
  const double h0 = 1e-3;
  const double viscosity = 10.0;
  const double youngs_modulus = 1e5;
  const double nu = 0.45;
  const double pi = 3.14159265358979323846;
  const double k = 2.0 * pi / wavelength;
  const double x = k * height;
  const double stiffness = youngs_modulus * k / (2.0 * (1.0 - nu * nu)) * (std::sinh(x) * std::sinh(x) - x * x) /
                           (std::sinh(x) * std::cosh(x) + x);
  const double sigma = h0 * h0 * h0 * k * k * stiffness / (12.0 * viscosity);
  EXPECT_NEAR(sigma, 0.77980, 1e-4);

  // Half a wavelength between symmetry planes; one cell across, held on rollers too: plane strain.
  const int n = 32;
  simulation::FaceModelSpec model_spec;
  model_spec.region = geometry::SquareSpec{0.5 * wavelength, 4.0 * 0.5 * wavelength / n};
  model_spec.n_xi = n;
  model_spec.n_eta = 2;
  model_spec.layers = {{"layer", {ScalarField::constant(height), 8}, {youngs_modulus, nu, 1100.0}}};
  model_spec.rim.kind = simulation::SupportKind::kRollers;
  auto model = simulation::build_face_model(model_spec, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  simulation::SimulationSpec spec;
  spec.fat_viscosity = viscosity;
  spec.films = {make_film(simulation::FilmWallKind::kTissue, n / 2, 1)};
  spec.films[0].below_layer = "layer";
  spec.films[0].rest_thickness = ScalarField::constant(h0);
  const int samples = 257;
  ScalarField start{samples, 1, {}};
  const double amplitude = 0.002 * h0;
  for (int i = 0; i < samples; ++i) start.values.push_back(h0 + amplitude * std::cos(pi * i / (samples - 1)));
  spec.films[0].initial_thickness = start;
  spec.probes = {{"crest", "film", geometry::ChartPoint{0.01, 0.5}}};
  spec.step = 0.01;
  spec.end = 1.0;
  spec.settle_skin_speed = 0.0;
  auto simulation = make_simulation(*model, spec);
  ASSERT_TRUE(simulation);
  const double before = simulation->report().probe_thickness[0] - h0;
  run(*simulation);
  const double after = simulation->report().probe_thickness[0] - h0;
  const double measured = std::log(before / after) / simulation->report().time;
  // Implicit Euler at 10 ms damps by log(1 + sigma dt)/dt.
  const double expected = std::log(1.0 + sigma * spec.step) / spec.step;
  std::printf("sinusoid under a layer: rate %.5f 1/s, expected %.5f (%.2f %%)\n", measured, expected,
              100 * (measured / expected - 1));
  EXPECT_NEAR(measured, expected, 0.01 * expected);
}

}  // namespace
}  // namespace lipofill::verification
