#include "core/simulation/simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

TEST(SimulationRun, KeepsTheLedgersEveryStepAndSettles) {
  plan::SimulationSpec spec = make_small_plan();
  spec.max_step = 0.2;
  const auto simulation = make_small_simulation(spec);
  double last_time = 0.0;
  while (simulation->phase() == Phase::kRunning) {
    simulation->advance_step();
    const StepReport& report = simulation->report();
    EXPECT_GT(report.time, last_time);
    last_time = report.time;
    EXPECT_LT(report.film_volume_relative_error, 1e-10);
    EXPECT_LT(report.gap_volume_relative_error, 1e-4);
    EXPECT_GT(report.min_scaled_jacobian, 0.1);
  }
  EXPECT_EQ(simulation->phase(), Phase::kSettled) << simulation->reason();
  EXPECT_NEAR(simulation->report().injected, 0.3e-6, 1e-18);
  // What goes in comes out as lifted skin, but for what the soft layer below gives way.
  EXPECT_GT(simulation->report().skin_volume_change, 0.2e-6);
  EXPECT_LE(simulation->report().skin_volume_change, 0.31e-6);
  EXPECT_GT(simulation->report().probe_thickness[0], 1e-4);
}

TEST(SimulationRun, LumpedKeepsTheTotalVolume) {
  plan::SimulationSpec spec = make_small_plan();
  spec.coupling = plan::CouplingMode::kLumped;
  const auto simulation = make_small_simulation(spec);
  for (int k = 0; k < 40; ++k) simulation->advance_step();
  ASSERT_EQ(simulation->phase(), Phase::kRunning) << simulation->reason();
  const StepReport& report = simulation->report();
  EXPECT_LT(report.film_volume_relative_error, 1e-10);
  EXPECT_NEAR(report.gap_volume, report.film_volume, 1e-4 * report.film_volume);
}

TEST(SimulationRun, ZonesAreSealedFromEachOther) {
  plan::SimulationSpec spec = make_small_plan();
  spec.films[0].zones = {{"left", geometry::ChartBox{0.0, 0.5, 0.0, 1.0}},
                         {"right", geometry::ChartBox{0.5, 1.0, 0.0, 1.0}}};
  spec.injections = {{"left", 0.2e-6, 1e-6, std::nullopt, std::nullopt}};
  const auto simulation = make_small_simulation(spec);
  const double before = simulation->zone_reports()[1].volume;
  for (int k = 0; k < 40; ++k) simulation->advance_step();
  EXPECT_NEAR(simulation->zone_reports()[1].volume, before, 1e-15 * before + 1e-22);
  EXPECT_NEAR(simulation->zone_reports()[0].volume, before + 0.2e-6, 1e-12);
}

TEST(SimulationRun, PaintedZoneIsThatOfItsCells) {
  plan::SimulationSpec boxed = make_small_plan();
  boxed.films[0].zones = {{"all", geometry::ChartBox{0.0, 0.5, 0.0, 1.0}}};
  boxed.injections[0].site = geometry::ChartPoint{0.25, 0.45};
  boxed.probes.clear();
  plan::SimulationSpec painted = boxed;
  // Bilinear from 1 to 0: a half at xi = 0.5, between two columns of cells.
  painted.films[0].zones = {{"all", plan::PaintedRegion{geometry::ScalarField{2, 1, {1.0, 0.0}}}}};
  const auto one = make_small_simulation(boxed);
  const auto other = make_small_simulation(painted);
  for (int k = 0; k < 5; ++k) {
    one->advance_step();
    other->advance_step();
  }
  EXPECT_EQ(one->state_hash(), other->state_hash());
}

TEST(SimulationRun, TakesFatOutAgainButNoMoreThanThereIs) {
  plan::SimulationSpec spec = make_small_plan();
  spec.injections = {{"all", 0.2e-6, 2e-6, std::nullopt, std::nullopt}, {"all", -0.19e-6, 1e-6, 0.5, std::nullopt}};
  spec.settle_skin_speed = 0.0;
  spec.end = 3.0;
  const auto simulation = make_small_simulation(spec);
  while (simulation->report().time < 0.9 && simulation->phase() == Phase::kRunning) simulation->advance_step();
  ASSERT_EQ(simulation->phase(), Phase::kRunning) << simulation->reason();
  EXPECT_NEAR(simulation->report().injected, 0.01e-6, 1e-18);
  EXPECT_EQ(simulation->report().undelivered, 0.0);
  ASSERT_TRUE(simulation->inject({"all", -1e-6, 1e-6, std::nullopt, std::nullopt}).ok());
  while (simulation->phase() == Phase::kRunning) simulation->advance_step();
  EXPECT_EQ(simulation->phase(), Phase::kFinished) << simulation->reason();
  const StepReport& report = simulation->report();
  EXPECT_GT(report.film_volume, 0.0);
  EXPECT_GT(report.gap_volume, 0.0);
  EXPECT_LT(report.undelivered, -0.8e-6);
  EXPECT_NEAR(report.injected + report.undelivered, 0.01e-6 - 1e-6, 1e-15);
  EXPECT_LT(report.film_volume_relative_error, 1e-10);
}

/// Fat pressed between rigid walls has nowhere to go.
plan::SimulationSpec make_impossible_plan() {
  plan::SimulationSpec spec;
  plan::FilmSpec film;
  film.name = "film";
  film.wall = plan::FilmWallKind::kRigid;
  film.rest_thickness = geometry::ScalarField::constant(1e-3);
  film.n_xi = film.n_eta = 4;
  film.zones = {{"all", geometry::ChartBox{}}};
  spec.films = {film};
  spec.injections = {{"all", 0.1e-6, 1e-6, 0.05, std::nullopt}};
  return spec;
}

TEST(SimulationRun, AFailedStepLeavesTheStateBeforeIt) {
  const auto simulation = make_small_simulation(make_impossible_plan());
  std::string before;
  while (simulation->phase() == Phase::kRunning) {
    before = simulation->state_hash();
    simulation->advance_step();
  }
  EXPECT_EQ(simulation->phase(), Phase::kFailed);
  EXPECT_THAT(simulation->reason(), testing::HasSubstr("film did not converge"));
  EXPECT_EQ(simulation->state_hash(), before);
  simulation->advance_step();
  EXPECT_EQ(simulation->state_hash(), before);
}

TEST(SimulationRun, LiveInjectionEqualsAPlannedOne) {
  plan::SimulationSpec planned = make_small_plan();
  planned.injections.push_back({"all", 0.1e-6, 1e-6, 0.4, std::nullopt});
  plan::SimulationSpec live = make_small_plan();
  const auto a = make_small_simulation(planned);
  const auto b = make_small_simulation(live);
  ASSERT_TRUE(b->inject({"all", 0.1e-6, 1e-6, 0.4, std::nullopt}).ok());
  for (int k = 0; k < 60; ++k) {
    a->advance_step();
    b->advance_step();
  }
  EXPECT_EQ(a->state_hash(), b->state_hash());
}

TEST(SimulationRun, RefusesALiveInjectionOnceItHasEnded) {
  plan::SimulationSpec spec = make_small_plan();
  spec.end = 0.05;
  const auto simulation = make_small_simulation(spec);
  while (simulation->phase() == Phase::kRunning) simulation->advance_step();
  EXPECT_EQ(simulation->phase(), Phase::kFinished);
  EXPECT_NEAR(simulation->report().time, 0.05, 1e-12);
  EXPECT_EQ(simulation->inject({"all", 1e-7, 1e-6, std::nullopt, std::nullopt}).code(),
            absl::StatusCode::kFailedPrecondition);
}

TEST(SimulationRun, TwoFilmsInOnePlan) {
  model::FaceModelSpec model_spec = make_small_model_spec();
  model_spec.layers.insert(model_spec.layers.begin() + 1,
                           {"smas", {geometry::ScalarField::constant(1e-3), 1}, {5e4, 0.45, 1050.0}});
  const auto model = model::build_face_model(model_spec, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  plan::SimulationSpec spec = make_small_plan();
  plan::FilmSpec deep = spec.films[0];
  deep.name = "deep";
  deep.below_layer = "smas";
  deep.zones = {{"below", geometry::ChartBox{}}};
  spec.films.push_back(deep);
  spec.settle_skin_speed = 0.0;
  spec.injections = {{"all", 0.1e-6, 1e-6, 0.0, std::nullopt}, {"below", 0.2e-6, 1e-6, 0.0, std::nullopt}};
  auto created = Simulation::create(*model, spec);
  ASSERT_TRUE(created.ok()) << created.status();
  for (int k = 0; k < 30; ++k) (*created)->advance_step();
  ASSERT_EQ((*created)->phase(), Phase::kRunning) << (*created)->reason();
  const auto zones = (*created)->zone_reports();
  ASSERT_EQ(zones.size(), 2u);
  EXPECT_NEAR(zones[1].volume - zones[0].volume, 0.1e-6, 1e-15);
  EXPECT_LT((*created)->report().gap_volume_relative_error, 1e-4);
}

TEST(SimulationFrames, MatchTheirTopologyAndTheReport) {
  const auto simulation = make_small_simulation();
  for (int k = 0; k < 10; ++k) simulation->advance_step();
  const std::vector<MeshTopology> meshes = simulation->topology();
  ASSERT_EQ(meshes.size(), 3u);
  for (const FrameField& field : simulation->frame({})) {
    const auto mesh = std::find_if(meshes.begin(), meshes.end(), [&](const auto& m) { return m.name == field.mesh; });
    ASSERT_NE(mesh, meshes.end()) << field.mesh;
    const int count = field.location == FieldLocation::kPoint ? mesh->n_points() : mesh->n_cells();
    EXPECT_EQ(field.values.size(), static_cast<size_t>(count) * field.components) << field.mesh << "." << field.name;
    if (field.mesh != "skin" || field.name != "displacement") continue;
    double largest = 0.0;
    for (size_t k = 0; k < field.values.size(); k += 3) {
      largest =
          std::max(largest, std::hypot(static_cast<double>(field.values[k]), field.values[k + 1], field.values[k + 2]));
    }
    EXPECT_NEAR(largest, 1e3 * simulation->report().skin_max_displacement, 1e-5);
  }
  EXPECT_EQ(simulation->frame({"skin"}).size(), 4u);
}

TEST(SimulationFrames, NumberTheZonesUnderTheSkin) {
  plan::SimulationSpec spec = make_small_plan();
  spec.films[0].zones = {{"left", geometry::ChartBox{0.0, 0.5, 0.0, 1.0}},
                         {"right", geometry::ChartBox{0.5, 1.0, 0.0, 0.5}}};
  spec.injections[0].zone = "left";
  spec.injections[0].site.reset();
  spec.probes.clear();
  const auto fields = make_small_simulation(spec)->frame({"skin"});
  const auto zone = std::find_if(fields.begin(), fields.end(), [](const auto& field) { return field.name == "zone"; });
  ASSERT_NE(zone, fields.end());
  const auto at = [&](int i, int j) { return zone->values[static_cast<size_t>(j * 13 + i)]; };
  EXPECT_EQ(at(1, 1), 1.0f);
  EXPECT_EQ(at(11, 1), 2.0f);
  EXPECT_EQ(at(11, 11), 0.0f) << "outside every zone";
}

TEST(FaceModelHash, IsTheSameForTheSameSpecificationOnly) {
  EXPECT_EQ(make_small_model()->content_hash, make_small_model()->content_hash);
  model::FaceModelSpec other = make_small_model_spec();
  other.layers[0].material.youngs_modulus *= 1.0 + 1e-12;
  const auto model = model::build_face_model(other, nullptr);
  ASSERT_TRUE(model.ok());
  EXPECT_NE((*model)->content_hash, make_small_model()->content_hash);
}

}  // namespace
}  // namespace lipofill::simulation
