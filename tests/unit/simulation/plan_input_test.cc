// What a simulation refuses, each with the field, the value and the bound.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/field_violations.h"
#include "tests/unit/simulation/bad_plan.h"

namespace lipofill::simulation {
namespace {

using testing::Contains;
using testing::Field;
using testing::HasSubstr;

const double kNan = std::numeric_limits<double>::quiet_NaN();

TEST_P(PlanIsRefused, NamingFieldValueAndBound) {
  expect_refused(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Every, PlanIsRefused,
    testing::Values(
        BadPlan{"Viscosity", [](auto& s) { s.fat_viscosity = -1; }, "fat.viscosity_pa_s", "-1"},
        BadPlan{"ViscosityNan", [](auto& s) { s.fat_viscosity = kNan; }, "fat.viscosity_pa_s", "nan"},
        BadPlan{"Density", [](auto& s) { s.fat_density = 0; }, "fat.density_kg_m3", "[1, 30000]"},
        BadPlan{"Step", [](auto& s) { s.step = 0; }, "time.step_ms", "0 ms"},
        BadPlan{"MaxStep", [](auto& s) { s.max_step = 1e-3; }, "time.max_step_ms", "is 1 ms, must be in [10"},
        BadPlan{"MaxInjectionStep", [](auto& s) { s.max_injection_step = 1e-3; }, "time.max_injection_step_ms",
                "is 1 ms, must be in [10"},
        BadPlan{"MaxInjectionStepTooLong", [](auto& s) { s.max_injection_step = 61.0; }, "time.max_injection_step_ms",
                "60000]"},
        BadPlan{"End", [](auto& s) { s.end = -1; }, "time.end_s", "-1 s"},
        BadPlan{"NoFilm", [](auto& s) { s.films.clear(); }, "films", "at least 1"},
        BadPlan{"Layer", [](auto& s) { s.films[0].below_layer = "bone"; }, "films[0].below_layer", "'bone'"},
        BadPlan{"TooFine", [](auto& s) { s.films[0].n_xi = 8; }, "films[0].n_xi", "spans 1.5 hexahedra"},
        BadPlan{"NoCells", [](auto& s) { s.films[0].n_eta = -1; }, "films[0].n_eta", "[1, 65536]"},
        BadPlan{"NoZone", [](auto& s) { s.films[0].zones.clear(); }, "films[0].zones", "at least 1"},
        BadPlan{"ZoneOutside",
                [](auto& s) {
                  s.films[0].extent = {0.0, 0.5, 0.0, 1.0};
                  s.films[0].n_xi = 3;
                  s.films[0].zones[0].shape = geometry::ChartBox{0.8, 0.9, 0.1, 0.2};
                },
                "films[0].zones[0]", "claims no film cell"},
        BadPlan{"DiscOutside",
                [](auto& s) {
                  s.films[0].zones[0].shape = plan::Disc{geometry::ChartPoint{1.5, 0.5}, 0.01};
                },
                "films[0].zones[0].disc.centre", "1.5"},
        BadPlan{"Region", [](auto& s) { s.films[0].zones[0].shape = plan::NamedRegion{"elbow_left"}; },
                "films[0].zones[0].region", "'elbow_left'"},
        BadPlan{"Painted",
                [](auto& s) {
                  s.films[0].zones[0].shape = plan::PaintedRegion{geometry::ScalarField{2, 2, {0, 1}}};
                },
                "films[0].zones[0].painted", "2"},
        BadPlan{"PaintedNothing",
                [](auto& s) { s.films[0].zones[0].shape = plan::PaintedRegion{geometry::ScalarField::constant(0.4)}; },
                "films[0].zones[0]", "claims no film cell"},
        BadPlan{"RestThickness", [](auto& s) { s.films[0].rest_thickness = geometry::ScalarField::constant(-1e-3); },
                "films[0].rest_thickness_mm", "-1 mm"},
        BadPlan{"InitialThickness",
                [](auto& s) {
                  s.films[0].initial_thickness = geometry::ScalarField{2, 2, {0, 0, 0}};
                },
                "films[0].initial_thickness_mm", "3"},
        BadPlan{"InjectionZone", [](auto& s) { s.injections[0].zone = "nowhere"; }, "injections[0].zone", "'nowhere'"},
        BadPlan{"Volume", [](auto& s) { s.injections[0].volume = 1e-3; }, "injections[0].volume_ml", "is 1000 mL"},
        BadPlan{"VolumeNan", [](auto& s) { s.injections[0].volume = kNan; }, "injections[0].volume_ml", "not a number"},
        BadPlan{"Rate", [](auto& s) { s.injections[0].rate = 0; }, "injections[0].rate_ml_per_s", "0 mL/s"},
        BadPlan{"Start", [](auto& s) { s.injections[0].start = -2.0; }, "injections[0].start_s", "-2 s"},
        BadPlan{"Site",
                [](auto& s) {
                  s.films[0].zones[0].shape = geometry::ChartBox{0.0, 0.5, 0.0, 1.0};
                  s.injections[0].site = geometry::ChartPoint{0.9, 0.9};
                },
                "injections[0].site", "(0.9, 0.9)"},
        BadPlan{"ProbeFilm", [](auto& s) { s.probes[0].film = "other"; }, "probes[0].film", "'other'"},
        BadPlan{"ProbePlace",
                [](auto& s) {
                  s.probes[0].place = geometry::ChartPoint{-0.5, 0.5};
                },
                "probes[0].place", "-0.5"},
        BadPlan{"Gravity", [](auto& s) { s.gravity.x() = kNan; }, "gravity_m_s2", "nan"},
        BadPlan{"Damping", [](auto& s) { s.damping_mass = -1; }, "damping.mass_per_s", "-1"},
        BadPlan{"TwiceTheZone",
                [](auto& s) {
                  s.films[0].zones[0].shape = geometry::ChartBox{0.0, 0.5, 0.0, 1.0};
                  s.films[0].zones.push_back({"all", geometry::ChartBox{0.5, 1.0, 0.0, 1.0}});
                },
                "films[0].zones[1].name", "a second time"}),
    [](const auto& test) { return test.param.name; });

struct BadModel {
  std::string name;
  std::function<void(model::FaceModelSpec&)> spoil;
  std::string field;
};

class ModelIsRefused : public testing::TestWithParam<BadModel> {};

TEST_P(ModelIsRefused, NamingTheField) {
  model::FaceModelSpec spec = make_small_model_spec();
  GetParam().spoil(spec);
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_FALSE(model.ok());
  EXPECT_EQ(model.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(field_violations_of(model.status()), Contains(Field(&FieldViolation::field, GetParam().field)))
      << model.status();
}

INSTANTIATE_TEST_SUITE_P(
    Every, ModelIsRefused,
    testing::Values(
        BadModel{"Modulus", [](auto& s) { s.layers[0].material.youngs_modulus = -5; }, "layers[0].youngs_modulus_kpa"},
        BadModel{"PoissonHalf", [](auto& s) { s.layers[1].material.poisson_ratio = 0.5; }, "layers[1].poisson_ratio"},
        BadModel{"PoissonNegative", [](auto& s) { s.layers[1].material.poisson_ratio = -0.1; },
                 "layers[1].poisson_ratio"},
        BadModel{"Density", [](auto& s) { s.layers[0].material.density = kNan; }, "layers[0].density_kg_m3"},
        BadModel{"Thickness", [](auto& s) { s.layers[0].geometry.thickness = geometry::ScalarField::constant(-1e-3); },
                 "layers[0].thickness_mm"},
        BadModel{"Name", [](auto& s) { s.layers[1].name = "skin"; }, "layers[1].name"},
        BadModel{"Counts", [](auto& s) { s.n_xi = 100000; }, "n_xi"},
        BadModel{"ElasticRim",
                 [](auto& s) {
                   s.rim = {model::SupportKind::kElastic, 0.0};
                 },
                 "rim.stiffness_kpa_per_mm"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace lipofill::simulation
