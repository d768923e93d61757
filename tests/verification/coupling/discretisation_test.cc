// The estimate of what the grid makes of a result, against refined grids.

#include "core/simulation/discretisation.h"

#include <cmath>
#include <memory>

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ScalarField;
using simulation::DiscretisationError;

/// Skin on muscle, n x n hexahedra over 60 mm, under it a disc of 15 mm that an attachment holds.
std::unique_ptr<simulation::Simulation> settle_disc(int n, double volume) {
  model::FaceModelSpec model_spec;
  model_spec.region = geometry::SquareSpec{0.06, 0.06};
  model_spec.n_xi = model_spec.n_eta = n;
  model_spec.layers = {{"skin", {ScalarField::constant(3e-3), 1}, {1e5, 0.45, 1100.0}},
                       {"muscle", {ScalarField::constant(6e-3), 1}, {3e5, 0.45, 1050.0}}};
  const auto model = model::build_face_model(model_spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  plan::SimulationSpec spec;
  spec.films = {make_film(plan::FilmWallKind::kTissue, n / 2, n / 2)};
  spec.films[0].below_layer = "skin";
  spec.films[0].zones = {{"disc", plan::Disc{geometry::ChartPoint{0.51, 0.48}, 15e-3}}};
  spec.films[0].rest_thickness = ScalarField::constant(0.05e-3);
  spec.films[0].edge.attachment = plan::AttachmentSpec{2e7, 4e-3};
  spec.injections = {{"disc", volume, volume / 0.5, 0.0, std::nullopt}};
  spec.fat_viscosity = 1.0;
  spec.step = 0.02;
  spec.max_step = 5.0;
  spec.end = 1000.0;
  spec.settle_skin_speed = 1e-8;
  auto simulation = make_simulation(*model, spec);
  if (simulation) run(*simulation);
  return simulation;
}

TEST(Discretisation, TheEstimateIsTheErrorThatRefinedGridsShow) {
  Case resolution({"coupled/11-discretisation-error", "The estimate of the error of the grid",
                   "Richardson's extrapolation of the results of 48 and 96 divisions, order 2."});
  const auto coarse = settle_disc(24, 0.8e-6);
  const auto fine = settle_disc(48, 0.8e-6);
  const auto finest = settle_disc(96, 0.8e-6);
  ASSERT_TRUE(coarse && fine && finest);
  ASSERT_EQ(coarse->phase(), simulation::Phase::kSettled) << coarse->reason();
  const auto limit = [&](auto figure) { return figure(*finest) + (figure(*finest) - figure(*fine)) / 3.0; };
  const auto lift = [](const simulation::Simulation& s) { return s.report().skin_max_displacement; };
  const auto pressure = [](const simulation::Simulation& s) { return s.zone_reports()[0].mean_pressure; };
  const auto estimate = simulation::estimate_discretisation_error(*coarse);
  ASSERT_TRUE(estimate.ok()) << estimate.status();
  const double lift_error = std::abs(lift(*coarse) / limit(lift) - 1.0);
  const double pressure_error = std::abs(pressure(*coarse) / limit(pressure) - 1.0);
  printf("24 divisions: lift off by %.3f %%, estimate %.3f %%; pressure %.3f %%, estimate %.3f %%\n", 100 * lift_error,
         100 * estimate->lift, 100 * pressure_error, 100 * estimate->pressure);
  resolution.record({"true error of the lift over its estimate, 24 divisions", "1", 1.5,
                     lift_error / (estimate->lift + 1e-3), 0.0, Bound::kAtMost});
  resolution.record({"true error of the pressure over its estimate, 24 divisions", "1", 1.5,
                     pressure_error / (estimate->pressure + 1e-3), 0.0, Bound::kAtMost});
  resolution.record({"estimate of the lift's error, 24 divisions", "1", 5.0 * lift_error + 2e-3, estimate->lift, 0.0,
                     Bound::kAtMost});
  const auto finer = simulation::estimate_discretisation_error(*fine);
  ASSERT_TRUE(finer.ok()) << finer.status();
  resolution.record({"estimate for the pressure at 48 divisions over that at 24", "1", 0.6,
                     finer->pressure / estimate->pressure, 0.0, Bound::kAtMost});
  EXPECT_NE(simulation::remark_on(*estimate), "");
  EXPECT_EQ(simulation::remark_on(DiscretisationError{0.01, 0.04, 0.02e-3}), "");
}

TEST(Discretisation, WhereNothingCanBeSaidTheReasonIs) {
  const auto coarse = settle_disc(8, 0.2e-6);
  ASSERT_TRUE(coarse);
  const auto none = simulation::estimate_discretisation_error(*coarse);
  EXPECT_EQ(none.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_NE(none.status().message().find("too few divisions"), std::string::npos) << none.status();
}

}  // namespace
}  // namespace lipofill::verification
