// A film under a clamped plate at rest, through the public simulation interface: the pressure is
// even, and as high as the injected volume makes it.

#include <vector>

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ScalarField;

constexpr double kPi = 3.14159265358979323846;
constexpr double kSide = 0.04;
constexpr double kYoungsModulus = 2e5;
constexpr double kNu = 0.45;

double bending_stiffness(double thickness) {
  return kYoungsModulus * std::pow(thickness, 3) / (12.0 * (1.0 - kNu * kNu));
}

/// A square plate clamped on its rim, over rigid bone with a film in between.
std::shared_ptr<const model::FaceModel> make_plate(double thickness, int n) {
  model::FaceModelSpec spec;
  spec.region = geometry::SquareSpec{kSide, kSide};
  spec.n_xi = spec.n_eta = n;
  spec.layers = {{"plate", {ScalarField::constant(thickness), 1}, {kYoungsModulus, kNu, 1100.0}}};
  auto model = model::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return *model;
}

struct Inflated {
  double pressure = 0.0;    ///< [Pa]
  double deflection = 0.0;  ///< the middle moves this far [m]
};

/// At rest, with `volume` injected below a plate of n x n elements.
Inflated inflate(double thickness, int n, double volume, const plan::ZoneSpec& zone) {
  plan::SimulationSpec spec;
  spec.films = {make_film(plan::FilmWallKind::kTissue, n / 2, n / 2)};
  spec.films[0].below_layer = "plate";
  spec.films[0].zones = {zone};
  spec.films[0].rest_thickness = ScalarField::constant(3e-3);
  spec.injections = {{zone.name, volume, volume / 0.1, 0.0, std::nullopt}};
  spec.fat_viscosity = 1e-3;
  spec.step = 0.02;
  spec.max_step = 5.0;
  spec.end = 5000.0;
  spec.settle_skin_speed = 1e-9 * thickness;
  auto simulation = make_simulation(make_plate(thickness, n), spec);
  if (!simulation) return {};
  run(*simulation);
  const simulation::StepReport& report = simulation->report();
  EXPECT_LT(report.gap_volume_relative_error, 1e-4);
  EXPECT_LT(report.film_volume_relative_error, 1e-10);
  EXPECT_NEAR(report.max_pressure, report.min_pressure, 1e-3 * report.mean_pressure);
  return {report.mean_pressure, report.skin_max_displacement};
}

/// Kirchhoff's, for a pressure that lifts the middle by a five-hundredth of the thickness: linear.
struct SquarePlate {
  double pressure, volume, deflection;
  explicit SquarePlate(double thickness) {
    const double D = bending_stiffness(thickness);
    deflection = thickness / 500.0;
    pressure = deflection * D / (0.00126532 * std::pow(kSide, 4));
    volume = 3.89120e-4 * pressure * std::pow(kSide, 6) / D;
  }
};

/// Pressure and deflection over Kirchhoff's for the same volume.
Inflated relative_square(double thickness, int n) {
  const SquarePlate expected(thickness);
  const Inflated measured = inflate(thickness, n, expected.volume, {"all", geometry::ChartBox{}});
  return {measured.pressure / expected.pressure, measured.deflection / expected.deflection};
}

Case square_case() {
  return Case({"coupled/6a-inflated-square", "Clamped square plate inflated by the film at rest",
               "Kirchhoff: V = 3.89120e-4 p b^6/D, w0 = 0.00126532 p b^4/D, approached as t/b -> 0."});
}

TEST(InflatedPlate, SquareApproachesKirchhoffAsItThins) {
  Case square = square_case();
  const std::vector<double> ratios = {1.0 / 20.0, 1.0 / 40.0, 1.0 / 80.0};
  const Inflated limit = relative_square(kSide / 400.0, 32);
  square.record({"p/Kirchhoff of the injected volume, 32 x 32, t/b = 1/400", "1", 1.0, limit.pressure, 0.01});
  square.record({"w0/Kirchhoff of the injected volume, 32 x 32, t/b = 1/400", "1", 1.0, limit.deflection, 0.01});
  std::vector<double> shear;
  for (const double ratio : ratios) shear.push_back(relative_square(kSide * ratio, 32).pressure - limit.pressure);
  square.record_series({"p less its thin limit", "t/b", ratios, shear, 2.0, 1.8});
}

TEST(InflatedPlate, SquareConvergesUnderRefinement) {
  Case square = square_case();
  const std::vector<double> sizes = {8, 16, 32};
  std::vector<double> errors;
  for (const double n : sizes) errors.push_back(relative_square(kSide / 400.0, static_cast<int>(n)).pressure - 1.0);
  square.record_series({"p at t/b = 1/400", "elements a side", sizes, errors, 2.0, 1.6});
}

/// The rim of a disc on a square grid is a staircase: its radius is only known to within an
/// element. For any radius, w0 = p a^4/(64 D) and V = pi p a^6/(192 D) give a^2 = 3 V/(pi w0), and
/// with it p without a.
TEST(InflatedPlate, DiscHasTheDeflectionAndPressureOfItsRadius) {
  Case circle({"coupled/6b-inflated-disc", "Clamped circular plate inflated by the film at rest",
               "Kirchhoff: w0 = p a^4/(64 D), V = pi p a^6/(192 D); the rim follows the grid's cells."});
  const double thickness = kSide / 200.0;
  const double D = bending_stiffness(thickness);
  const double a = 0.45 * kSide;
  const double w0 = thickness / 500.0;
  const double volume = kPi * a * a * w0 / 3.0;
  std::vector<double> radii;
  const std::vector<double> sizes = {32, 64};
  Inflated fine;
  for (const double n : sizes) {
    const plan::Disc disc{geometry::ChartPoint{0.5, 0.5}, a};
    fine = inflate(thickness, static_cast<int>(n), volume, {"disc", disc});
    radii.push_back(std::sqrt(3.0 * volume / (kPi * fine.deflection)));
  }
  const double pressure = 64.0 * D * fine.deflection / std::pow(radii.back(), 4);
  circle.record({"radius from V and w0, 64 x 64", "mm", 1e3 * a, 1e3 * radii.back(), 0.03});
  circle.record({"p of that radius, 64 x 64", "Pa", pressure, fine.pressure, 0.02});
  circle.record_series({"radius", "elements a side", sizes, {radii[0] / a - 1.0, radii[1] / a - 1.0}, 1.0, 0.7});
}

}  // namespace
}  // namespace lipofill::verification
