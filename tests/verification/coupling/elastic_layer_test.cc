// A film of rest thickness h0 between rigid bone and an elastic layer of thickness H, free on its
// outer face: a sinusoid of wavenumber k decays at
//
//     sigma = h0^3 k^2 S/(12 mu),   S = E k/(2 (1 - nu^2)) (sinh^2 x - x^2)/(sinh x cosh x + x),   x = k H

#include <vector>

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ScalarField;

constexpr double kPi = 3.14159265358979323846;
constexpr double kWavelength = 0.04;
constexpr double kHeight = 0.01;
constexpr double kRest = 1e-3;
constexpr double kViscosity = 10.0;
constexpr double kYoungsModulus = 1e5;
constexpr double kNu = 0.45;
constexpr double kStep = 0.01;

double decay_rate() {
  const double k = 2.0 * kPi / kWavelength;
  const double x = k * kHeight;
  const double sh = std::sinh(x);
  const double stiffness = kYoungsModulus * k / (2.0 * (1.0 - kNu * kNu)) * (sh * sh - x * x) / (sh * std::cosh(x) + x);
  return std::pow(kRest, 3) * k * k * stiffness / (12.0 * kViscosity);
}

/// Half a wavelength between planes of symmetry, a narrow strip on rollers: plane strain.
std::shared_ptr<const model::FaceModel> make_strip(int n, int through) {
  model::FaceModelSpec spec;
  spec.region = geometry::SquareSpec{0.5 * kWavelength, 2.0 * kWavelength / n};
  spec.n_xi = n;
  spec.n_eta = 2;
  spec.layers = {{"layer", {ScalarField::constant(kHeight), through}, {kYoungsModulus, kNu, 1100.0}}};
  spec.rim.kind = model::SupportKind::kRollers;
  auto model = model::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return *model;
}

/// Amplitude of the cosine at the crest's cell over time, and the rate at which it decays.
struct Decay {
  std::vector<double> time, amplitude;
  double rate() const { return std::log(amplitude.front() / amplitude.back()) / time.back(); }
};

Decay measure_decay(int elements_a_wavelength, int through) {
  const int n = elements_a_wavelength / 2;
  plan::SimulationSpec spec;
  spec.fat_viscosity = kViscosity;
  spec.films = {make_film(plan::FilmWallKind::kTissue, n / 2, 1)};
  spec.films[0].below_layer = "layer";
  spec.films[0].rest_thickness = ScalarField::constant(kRest);
  const int samples = 257;
  ScalarField start{samples, 1, {}};
  const double amplitude = 0.002 * kRest;
  for (int i = 0; i < samples; ++i) start.values.push_back(kRest + amplitude * std::cos(kPi * i / (samples - 1)));
  spec.films[0].initial_thickness = start;
  spec.probes = {{"crest", "film", geometry::ChartPoint{0.01, 0.5}}};
  spec.step = kStep;
  spec.end = 1.0;
  spec.settle_skin_speed = 0.0;
  auto simulation = make_simulation(make_strip(n, through), spec);
  if (!simulation) return {};
  Decay decay{{0.0}, {simulation->report().probe_thickness[0] - kRest}};
  while (simulation->phase() == simulation::Phase::kRunning) {
    simulation->advance_step();
    decay.time.push_back(simulation->report().time);
    decay.amplitude.push_back(simulation->report().probe_thickness[0] - kRest);
  }
  EXPECT_EQ(simulation->phase(), simulation::Phase::kFinished) << simulation->reason();
  return decay;
}

TEST(SinusoidUnderElasticLayer, DecaysAtTheClosedRate) {
  Case layer({"coupled/5-elastic-layer", "A sinusoid decays under a finite elastic layer",
              "sigma = h0^3 k^2 S/(12 mu) with S of the layer in plane strain; what implicit Euler makes of it, "
              "ln(1 + sigma dt)/dt, dt = 10 ms."});
  const double sigma = decay_rate();
  EXPECT_NEAR(sigma, 0.77980, 1e-5);
  const double expected = std::log(1.0 + sigma * kStep) / kStep;
  const std::vector<double> elements = {16, 32, 64};
  std::vector<double> errors;
  Decay decay;
  for (const double n : elements) {
    decay = measure_decay(static_cast<int>(n), static_cast<int>(n / 4));
    errors.push_back(decay.rate() / expected - 1.0);
  }
  layer.record({"rate, 32 elements a wavelength and 8 through H", "1/s", expected, expected * (1.0 + errors[1]), 0.01});
  layer.record(
      {"rate, 64 elements a wavelength and 16 through H", "1/s", expected, expected * (1.0 + errors[2]), 0.003});
  layer.record_series({"rate", "elements a wavelength, 4 times those through H", elements, errors, 2.0, 1.8});
  Curve curve{"amplitude", "t [s]", "share of the start", decay.time, {}, {}};
  for (size_t k = 0; k < decay.time.size(); ++k) {
    curve.measured.push_back(decay.amplitude[k] / decay.amplitude[0]);
    curve.expected.push_back(std::exp(-sigma * decay.time[k]));
  }
  layer.record_curve(curve);
}

}  // namespace
}  // namespace lipofill::verification
