// A clamped plate over a pool of fat, solved directly: Kirchhoff's pressure for its volume.

#include <cmath>

#include "tests/verification/equilibrium/direct_case.h"
#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ScalarField;

constexpr double kSide = 0.04;
constexpr double kYoungsModulus = 2e5;
constexpr double kNu = 0.45;

/// Pressure and deflection of a square plate over Kirchhoff's, for a volume that lifts its middle
/// by a five-hundredth of the thickness.
struct Inflated {
  double pressure = 0.0;
  double deflection = 0.0;
};

Inflated inflate(double thickness, int n) {
  model::FaceModelSpec model_spec;
  model_spec.region = geometry::SquareSpec{kSide, kSide};
  model_spec.n_xi = model_spec.n_eta = n;
  model_spec.layers = {{"plate", {ScalarField::constant(thickness), 1}, {kYoungsModulus, kNu, 1100.0}}};
  const auto model = model::build_face_model(model_spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  const double stiffness = kYoungsModulus * std::pow(thickness, 3) / (12.0 * (1.0 - kNu * kNu));
  const double deflection = thickness / 500.0;
  const double pressure = deflection * stiffness / (0.00126532 * std::pow(kSide, 4));
  const double volume = 3.89120e-4 * pressure * std::pow(kSide, 6) / stiffness;

  plan::SimulationSpec spec;
  spec.films = {make_film(plan::FilmWallKind::kTissue, n / 2, n / 2)};
  spec.films[0].below_layer = "plate";
  spec.films[0].rest_thickness = ScalarField::constant(3e-3);
  spec.injections = {{"all", volume, volume / 0.1, 0.0, std::nullopt}};
  DirectCase direct(*model, spec);
  const equilibrium::Settled settled = direct.solve(1e-6);
  EXPECT_TRUE(settled.is_whole()) << settled.reason;
  return {settled.pool_head[0] / pressure, direct.skin(settled).colwise().norm().maxCoeff() / deflection};
}

TEST(InflatedPlateDirectly, SquareHasKirchhoffsPressureAndDeflection) {
  Case square({"coupled/6a-inflated-square", "Clamped square plate inflated by the film at rest",
               "Kirchhoff: V = 3.89120e-4 p b^6/D, w0 = 0.00126532 p b^4/D, approached as t/b -> 0."});
  const Inflated thin = inflate(kSide / 400.0, 32);
  square.record({"directly: p/Kirchhoff, 32 x 32, t/b = 1/400", "1", 1.0, thin.pressure, 0.01});
  square.record({"directly: w0/Kirchhoff, 32 x 32, t/b = 1/400", "1", 1.0, thin.deflection, 0.01});
}

TEST(InflatedPlateDirectly, SquareConvergesUnderRefinement) {
  Case square({"coupled/6a-inflated-square", "Clamped square plate inflated by the film at rest",
               "Kirchhoff: V = 3.89120e-4 p b^6/D, w0 = 0.00126532 p b^4/D, approached as t/b -> 0."});
  const std::vector<double> sizes = {8, 16, 32};
  std::vector<double> errors;
  for (const double n : sizes) errors.push_back(inflate(kSide / 400.0, static_cast<int>(n)).pressure - 1.0);
  square.record_series({"directly: p at t/b = 1/400", "elements a side", sizes, errors, 2.0, 1.6});
}

}  // namespace
}  // namespace lipofill::verification
