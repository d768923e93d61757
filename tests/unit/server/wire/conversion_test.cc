#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "core/base/field_violations.h"
#include "server/wire/model_conversion.h"
#include "server/wire/simulation_conversion.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

template <typename Message>
Message parse(const std::string& text) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

std::vector<std::string> fields_of(const absl::Status& status) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : field_violations_of(status)) fields.push_back(violation.field);
  return fields;
}

constexpr char kSquare[] = R"(
  square { length_xi_mm: 40 length_eta_mm: 30 } n_xi: 8 n_eta: 6
  layers { name: "skin" thickness_mm { constant: 2 } youngs_modulus_kpa: 100 poisson_ratio: 0.48 density_kg_m3: 1100 }
  rim { kind: ROLLERS } base { kind: ELASTIC stiffness_kpa_per_mm: 3 })";

TEST(ModelConversion, TurnsUnitsToSi) {
  const auto spec = to_face_model_spec(parse<v1::ModelSpec>(kSquare));
  ASSERT_TRUE(spec.ok()) << spec.status();
  const auto& square = std::get<geometry::SquareSpec>(spec->region);
  EXPECT_DOUBLE_EQ(square.length_xi, 0.040);
  EXPECT_DOUBLE_EQ(square.length_eta, 0.030);
  EXPECT_EQ(spec->n_xi, 8);
  ASSERT_EQ(spec->layers.size(), 1u);
  EXPECT_DOUBLE_EQ(spec->layers[0].geometry.thickness.at(0.5, 0.5), 0.002);
  EXPECT_EQ(spec->layers[0].geometry.elements_through, 0) << "it follows from the width";
  EXPECT_DOUBLE_EQ(spec->layers[0].material.youngs_modulus, 1e5);
  EXPECT_DOUBLE_EQ(spec->layers[0].material.density, 1100);
  EXPECT_EQ(spec->rim.kind, model::SupportKind::kRollers);
  EXPECT_EQ(spec->base.kind, model::SupportKind::kElastic);
  EXPECT_DOUBLE_EQ(spec->base.stiffness, 3e6);
}

TEST(ModelConversion, NamesEverythingThatIsMissing) {
  const auto spec =
      to_face_model_spec(parse<v1::ModelSpec>("square { length_xi_mm: 40 } layers { } base { kind: ELASTIC }"));
  EXPECT_THAT(fields_of(spec.status()),
              UnorderedElementsAre("square.length_eta_mm", "layers[0].name", "layers[0].thickness_mm",
                                   "layers[0].youngs_modulus_kpa", "layers[0].poisson_ratio", "layers[0].density_kg_m3",
                                   "base.stiffness_kpa_per_mm"));
  EXPECT_THAT(fields_of(to_face_model_spec(parse<v1::ModelSpec>("n_xi: 1 n_eta: 1")).status()), ElementsAre("square"));
}

TEST(ModelConversion, CountsThatAreLeftOutAreChosenAndZeroIsNone) {
  const auto spec = to_face_model_spec(parse<v1::ModelSpec>("square { length_xi_mm: 40 length_eta_mm: 30 } n_eta: 6"));
  ASSERT_TRUE(spec.ok()) << spec.status();
  EXPECT_EQ(spec->n_xi, 0);
  EXPECT_EQ(spec->n_eta, 6);
  const auto none =
      to_face_model_spec(parse<v1::ModelSpec>("square { length_xi_mm: 40 length_eta_mm: 30 } n_xi: 0 n_eta: 6"));
  EXPECT_THAT(fields_of(none.status()), ElementsAre("n_xi"));
}

TEST(ModelConversion, TheBaseOfAFaceInElastographyIsByRegionUnlessThePlanSaysOtherwise) {
  const std::string face = R"(scan_region { scan: "patients/a/scans/s" around { regions: "buccal_left" } } )";
  const auto kind = [&](const std::string& rest) {
    const auto spec = to_face_model_spec(parse<v1::ModelSpec>(face + rest));
    EXPECT_TRUE(spec.ok()) << spec.status();
    return spec->base.kind;
  };
  EXPECT_EQ(kind("tissue_preset: ELASTOGRAPHY"), model::SupportKind::kByRegion);
  EXPECT_EQ(kind("tissue_preset: ELASTOGRAPHY base { kind: CLAMPED }"), model::SupportKind::kClamped);
  EXPECT_EQ(kind("tissue_preset: PAPER"), model::SupportKind::kClamped);
  const auto soft = to_face_model_spec(
      parse<v1::ModelSpec>(face + "base { kind: BY_REGION stiffness_kpa_per_mm: 0.25 } tissue_preset: PAPER"));
  ASSERT_TRUE(soft.ok());
  EXPECT_DOUBLE_EQ(soft->base.stiffness, 0.25e6);
}

TEST(ModelConversion, ReadsAScanRegion) {
  const auto spec = to_face_model_spec(parse<v1::ModelSpec>(R"(
    scan_region {
      scan: "patients/a/scans/s" landmarks_mm { key: "nasion" value { x: 1 y: 2 z: 3 } }
      axes { left { x: 1 y: 0 z: 0 } up { x: 0 y: 1 z: 0 } forward { x: 0 y: 0 z: 1 } }
      corners { position_mm { x: 10 y: 0 z: 0 } } corners { landmarks { weights { key: "nasion" value: 1 } left_mm: 5 } }
      corners { position_mm { x: 10 y: 0 z: 0 } } corners { position_mm { x: 10 y: 0 z: 0 } }
    } n_xi: 4 n_eta: 4)"));
  ASSERT_TRUE(spec.ok()) << spec.status();
  const auto& region = std::get<geometry::ScanRegionSpec>(spec->region);
  EXPECT_TRUE(region.landmarks.at("nasion").isApprox(Eigen::Vector3d(0.001, 0.002, 0.003)));
  EXPECT_TRUE(std::get<Eigen::Vector3d>(region.corners[0]).isApprox(Eigen::Vector3d(0.01, 0, 0)));
  EXPECT_DOUBLE_EQ(std::get<geometry::LandmarkPoint>(region.corners[1]).left, 0.005);
  EXPECT_TRUE(region.axes->left.isApprox(Eigen::Vector3d::UnitX()));
}

TEST(ModelConversion, NamesWhatAScanRegionLacks) {
  const auto three =
      to_face_model_spec(parse<v1::ModelSpec>("scan_region { corners { } corners { } corners { } } n_xi: 1 n_eta: 1"));
  EXPECT_THAT(fields_of(three.status()), ElementsAre("scan_region.scan", "scan_region.corners"));
  const auto empty = to_face_model_spec(parse<v1::ModelSpec>(R"(
    scan_region { scan: "x" landmarks_mm { key: "menton" value { x: 1 y: 2 } } axes { left { x: 1 y: 0 z: 0 } up { x: 0 y: 1 z: 0 } }
      corners { } corners { chart { xi: 1 } } corners { position_mm { x: 1 y: 1 } } corners { landmarks { } } }
    n_xi: 1 n_eta: 1)"));
  EXPECT_THAT(fields_of(empty.status()),
              UnorderedElementsAre("scan_region.landmarks_mm[menton].z", "scan_region.axes.forward.x",
                                   "scan_region.axes.forward.y", "scan_region.axes.forward.z", "scan_region.corners[0]",
                                   "scan_region.corners[1].chart.eta", "scan_region.corners[2].position_mm.z",
                                   "scan_region.corners[3].landmarks.weights"));
}

TEST(ModelConversion, ChecksTheShapeOfSamples) {
  v1::ModelSpec message = parse<v1::ModelSpec>(kSquare);
  auto* samples = message.mutable_layers(0)->mutable_thickness_mm()->mutable_samples();
  samples->set_n_xi(2);
  samples->set_n_eta(2);
  for (const double value : {1.0, 2.0, 3.0}) samples->add_values(value);
  EXPECT_THAT(fields_of(to_face_model_spec(message).status()), ElementsAre("layers[0].thickness_mm.samples"));
  samples->add_values(4.0);
  const auto spec = to_face_model_spec(message);
  ASSERT_TRUE(spec.ok()) << spec.status();
  EXPECT_DOUBLE_EQ(spec->layers[0].geometry.thickness.at(1, 0), 0.002);
  samples->set_n_xi(4'000'000'000u);
  EXPECT_FALSE(to_face_model_spec(message).ok());
}

TEST(ModelConversion, RefusesCountsThatDoNotFit) {
  v1::ModelSpec message = parse<v1::ModelSpec>(kSquare);
  message.set_n_xi(3'000'000'000u);
  EXPECT_THAT(fields_of(to_face_model_spec(message).status()), ElementsAre("n_xi"));
}

constexpr char kPlan[] = R"(
  model: "patients/a/models/m" fat { viscosity_pa_s: 10 }
  films {
    name: "deep" below_layer: "skin" extent { xi_min: 0.1 xi_max: 0.9 eta_min: 0.2 eta_max: 0.8 } n_xi: 4 n_eta: 3
    zones { name: "a" box { xi_min: 0 xi_max: 1 eta_min: 0 eta_max: 1 } }
    zones { name: "b" disc { centre { chart { xi: 0.5 eta: 0.5 } } radius_mm: 4 } }
    zones { name: "c" region: "masseter_left" }
    zones { name: "d" painted { n_xi: 2 n_eta: 1 values: 0 values: 1 } }
    rest_thickness_mm { constant: 0.1 } initial_thickness_mm { constant: 0.2 }
    wall_friction: NONE wall { kind: WINKLER stiffness_kpa_per_mm: 2 }
  }
  injections { zone: "a" volume_ml: 2 rate_ml_per_s: 0.5 start_s: 1.5 site { chart { xi: 0.5 eta: 0.5 } } }
  time { step_ms: 20 max_step_ms: 100 end_s: 7 settle_skin_speed_mm_per_s: 0.5 }
  coupling: LUMPED gravity_m_s2 { x: 0 y: -9.81 z: 0 } damping { mass_per_s: 1 stiffness_s: 0.25 }
  probes { name: "p" film: "deep" place { chart { xi: 0.5 eta: 0.5 } } })";

TEST(SimulationConversion, TurnsUnitsToSi) {
  const auto spec = to_simulation_spec(parse<v1::SimulationSpec>(kPlan));
  ASSERT_TRUE(spec.ok()) << spec.status();
  EXPECT_DOUBLE_EQ(spec->fat_viscosity, 10);
  EXPECT_DOUBLE_EQ(spec->fat_density, 920) << "the default of the core";
  const plan::FilmSpec& film = spec->films[0];
  EXPECT_DOUBLE_EQ(film.extent.eta_max, 0.8);
  EXPECT_DOUBLE_EQ(std::get<plan::Disc>(film.zones[1].shape).radius, 0.004);
  EXPECT_EQ(std::get<plan::NamedRegion>(film.zones[2].shape).name, "masseter_left");
  EXPECT_DOUBLE_EQ(std::get<plan::PaintedRegion>(film.zones[3].shape).cover.at(0.25, 0.5), 0.25);
  EXPECT_DOUBLE_EQ(film.rest_thickness.at(0, 0), 1e-4);
  EXPECT_DOUBLE_EQ(film.initial_thickness->at(0, 0), 2e-4);
  EXPECT_EQ(film.wall_friction, film::WallFriction::kNone);
  EXPECT_EQ(film.wall, plan::FilmWallKind::kWinkler);
  EXPECT_DOUBLE_EQ(film.wall_stiffness, 2e6);
  EXPECT_DOUBLE_EQ(spec->injections[0].volume, 2e-6);
  EXPECT_DOUBLE_EQ(spec->injections[0].rate, 0.5e-6);
  EXPECT_DOUBLE_EQ(*spec->injections[0].start, 1.5);
  EXPECT_TRUE(spec->injections[0].site.has_value());
  EXPECT_DOUBLE_EQ(spec->step, 0.020);
  EXPECT_DOUBLE_EQ(*spec->max_step, 0.1);
  EXPECT_DOUBLE_EQ(spec->end, 7);
  EXPECT_DOUBLE_EQ(spec->settle_skin_speed, 0.5e-3);
  EXPECT_EQ(spec->coupling, plan::CouplingMode::kLumped);
  EXPECT_DOUBLE_EQ(spec->gravity.y(), -9.81);
  EXPECT_DOUBLE_EQ(spec->damping_stiffness, 0.25);
  EXPECT_EQ(spec->probes[0].film, "deep");
}

TEST(SimulationConversion, KeepsTheDefaultsOfTheCore) {
  const auto spec = to_simulation_spec(parse<v1::SimulationSpec>("model: 'm'"));
  ASSERT_TRUE(spec.ok()) << spec.status();
  const plan::SimulationSpec defaults;
  EXPECT_EQ(spec->fat_viscosity, defaults.fat_viscosity);
  EXPECT_EQ(spec->step, defaults.step);
  EXPECT_EQ(spec->end, defaults.end);
  EXPECT_EQ(spec->settle_skin_speed, defaults.settle_skin_speed);
  EXPECT_EQ(spec->coupling, defaults.coupling);
}

TEST(SimulationConversion, ReadsTheGoalAndLetsGivenStepsWin) {
  const auto few = to_simulation_spec(parse<v1::SimulationSpec>("model: 'm' time { goal: SETTLED_SHAPE }"));
  ASSERT_TRUE(few.ok()) << few.status();
  EXPECT_EQ(few->goal, plan::TimeGoal::kSettledShape);
  EXPECT_DOUBLE_EQ(*few->max_step, 60.0);
  EXPECT_DOUBLE_EQ(*few->max_injection_step, 0.5);
  EXPECT_DOUBLE_EQ(few->error_tolerance, 0.2e-3);
  const auto given = to_simulation_spec(parse<v1::SimulationSpec>(R"(model: 'm' time {
    goal: SETTLED_SHAPE step_ms: 20 max_step_ms: 300 max_injection_step_ms: 40 error_tolerance_mm: 0.01 })"));
  ASSERT_TRUE(given.ok()) << given.status();
  EXPECT_DOUBLE_EQ(*given->max_step, 0.3);
  EXPECT_DOUBLE_EQ(*given->max_injection_step, 0.04);
  EXPECT_DOUBLE_EQ(given->error_tolerance, 1e-5);
  const auto long_step =
      to_simulation_spec(parse<v1::SimulationSpec>("model: 'm' time { goal: SETTLED_SHAPE step_ms: 700 }"));
  EXPECT_DOUBLE_EQ(*long_step->max_injection_step, 0.7) << "no shorter than the step";
  const auto watched = to_simulation_spec(parse<v1::SimulationSpec>("model: 'm' time { max_injection_step_ms: 50 }"));
  EXPECT_EQ(watched->goal, plan::TimeGoal::kTransient);
  EXPECT_DOUBLE_EQ(*watched->max_injection_step, 0.05);
  EXPECT_FALSE(watched->max_step.has_value());
}

TEST(SimulationConversion, NamesEverythingThatIsMissing) {
  const auto spec = to_simulation_spec(parse<v1::SimulationSpec>(R"(
    films { zones { } zones { name: "b" disc { } } extent { xi_min: 0 } rest_thickness_mm { } wall { kind: WINKLER } }
    injections { } probes { } gravity_m_s2 { x: 1 })"));
  EXPECT_THAT(fields_of(spec.status()),
              UnorderedElementsAre("model", "films[0].name", "films[0].extent.xi_max", "films[0].extent.eta_min",
                                   "films[0].extent.eta_max", "films[0].zones[0].name", "films[0].zones[0].box",
                                   "films[0].zones[1].disc.centre", "films[0].zones[1].disc.radius_mm",
                                   "films[0].rest_thickness_mm", "films[0].wall.stiffness_kpa_per_mm",
                                   "injections[0].zone", "injections[0].volume_ml", "injections[0].rate_ml_per_s",
                                   "probes[0].name", "probes[0].place", "gravity_m_s2.y", "gravity_m_s2.z"));
}

TEST(InjectionConversion, NamesWhatIsMissing) {
  EXPECT_THAT(fields_of(to_injection_spec(parse<v1::Injection>("zone: 'a' site { }")).status()),
              UnorderedElementsAre("volume_ml", "rate_ml_per_s", "site"));
}

TEST(SimulationConversion, ReadsFatLigamentsWallsAndConnectiveTissue) {
  const auto spec = to_simulation_spec(parse<v1::SimulationSpec>(R"(
    model: "patients/a/models/b" fat { preset: COLEMAN yield_stress_pa: 3 } suction_limit_pa: 700
    films { name: "film" below_layer: "skin" n_xi: 4 n_eta: 4 zones { name: "a" box { xi_min: 0 xi_max: 1 eta_min: 0 eta_max: 1 } }
      walls { name: "septum" path { points { chart { xi: 0.5 eta: 0 } } points { chart { xi: 0.5 eta: 1 } } }
              leakage_ml_per_s_kpa_cm: 2 }
      connective_tissue { stiffness_kpa_per_mm: 0.5 entry_pressure_pa: 900 } }
    ligaments { name: "zygomatic" anatomical: "zygomatic_left" slack_mm: 1.5 }
    ligaments { name: "septum" points { points { chart { xi: 0.2 eta: 0.3 } } } stiffness_n_per_mm: 0.1 breaking_force_n: 4 }
    time { error_tolerance_mm: 0.1 })"));
  ASSERT_TRUE(spec.ok()) << spec.status();
  EXPECT_EQ(spec->fat_flow_index, 0.28);
  EXPECT_EQ(spec->fat_viscosity, 48.0);
  EXPECT_EQ(spec->fat_yield_stress, 3.0);
  EXPECT_EQ(spec->fat_shear_modulus, 70.0);
  EXPECT_EQ(spec->suction_limit, 700.0);
  EXPECT_DOUBLE_EQ(spec->error_tolerance, 1e-4);
  EXPECT_EQ(spec->films[0].walls[0].path.size(), 2u);
  EXPECT_DOUBLE_EQ(spec->films[0].walls[0].leakage, 2e-7);
  EXPECT_DOUBLE_EQ(spec->films[0].connective_tissue.stiffness, 5e5);
  EXPECT_EQ(spec->films[0].connective_tissue.entry_pressure, 900.0);
  EXPECT_EQ(std::get<plan::NamedLigament>(spec->ligaments[0].place).name, "zygomatic_left");
  EXPECT_DOUBLE_EQ(spec->ligaments[0].slack, 1.5e-3);
  EXPECT_FALSE(spec->ligaments[0].stiffness.has_value());
  EXPECT_DOUBLE_EQ(*spec->ligaments[1].stiffness, 100.0);
  EXPECT_EQ(spec->ligaments[1].breaking_force, 4.0);
}

TEST(SimulationConversion, NamesWhatDoesNotGoTogether) {
  const auto refused = [](const std::string& text) {
    return fields_of(to_simulation_spec(parse<v1::SimulationSpec>("model: \"m\" " + text)).status());
  };
  EXPECT_THAT(refused("fat { flow_index: 0.5 viscosity_pa_s: 10 }"), ElementsAre("fat.viscosity_pa_s"));
  EXPECT_THAT(refused("fat { consistency_pa_s_n: 10 }"), ElementsAre("fat.consistency_pa_s_n"));
  EXPECT_THAT(refused("fat { preset: COLEMAN flow_index: 0.5 }"), ElementsAre("fat.consistency_pa_s_n"));
  EXPECT_THAT(refused("ligaments { name: \"l\" }"), ElementsAre("ligaments[0].points"));
  EXPECT_THAT(refused("ligaments { name: \"l\" points { points { chart { xi: 0.1 eta: 0.1 } } } }"),
              ElementsAre("ligaments[0].stiffness_n_per_mm"));
  EXPECT_THAT(refused("films { name: \"f\" n_xi: 1 n_eta: 1 walls { name: \"w\" } }"),
              ElementsAre("films[0].walls[0].path"));
  EXPECT_THAT(refused("films { name: \"f\" n_xi: 1 n_eta: 1 walls { between { first: \"a\" } } }"),
              UnorderedElementsAre("films[0].walls[0].name", "films[0].walls[0].between.second"));
}

}  // namespace
}  // namespace lipofill::server
