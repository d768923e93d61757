// Springs between stiff plates that films of fat part: every force is known from the gaps.

#include <string>
#include <vector>

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ChartPoint;
using geometry::ScalarField;
using plan::LigamentSpec;

constexpr double kSide = 0.024;  // [m]
constexpr double kArea = kSide * kSide;
constexpr int kPoints = 4;  // a ligament has so many

/// Plates that slide up and down between rollers, stiff enough not to bend.
std::shared_ptr<const model::FaceModel> make_plates(const std::vector<std::string>& names) {
  model::FaceModelSpec spec;
  spec.region = geometry::SquareSpec{kSide, kSide};
  spec.n_xi = spec.n_eta = 8;
  spec.rim.kind = model::SupportKind::kRollers;
  for (const std::string& name : names) {
    model::TissueLayerSpec layer;
    layer.name = name;
    layer.geometry = {ScalarField::constant(4e-3), 1};
    layer.material = {1e9, 0.3, 1100.0};
    spec.layers.push_back(layer);
  }
  auto model = model::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return *model;
}

plan::FilmSpec make_film_below(const std::string& plate) {
  plan::FilmSpec film = make_film(plan::FilmWallKind::kTissue, 4, 4);
  film.name = "film_" + plate;
  film.below_layer = plate;
  film.zones[0].name = "zone_" + plate;
  return film;
}

LigamentSpec make_ligament(const std::string& name, const std::string& film, const std::string& inner,
                           double stiffness) {
  LigamentSpec ligament;
  ligament.name = name;
  ligament.film = film;
  ligament.inner_film = inner;
  ligament.place = std::vector<geometry::SkinPoint>{ChartPoint{0.27, 0.3}, ChartPoint{0.73, 0.3}, ChartPoint{0.27, 0.7},
                                                    ChartPoint{0.73, 0.7}};
  ligament.stiffness = stiffness;
  return ligament;
}

plan::SimulationSpec make_plan(const std::vector<std::string>& plates, double volume) {
  plan::SimulationSpec spec;
  for (const std::string& plate : plates) {
    spec.films.push_back(make_film_below(plate));
    spec.injections.push_back({"zone_" + plate, volume, volume, 0.0, std::nullopt});
  }
  spec.fat_viscosity = 0.5;
  spec.step = 0.02;
  spec.max_step = 1.0;
  spec.end = 40.0;
  spec.settle_skin_speed = 1e-9;
  return spec;
}

std::unique_ptr<simulation::Simulation> run_plan(const std::vector<std::string>& plates,
                                                 const plan::SimulationSpec& spec) {
  auto simulation = make_simulation(make_plates(plates), spec);
  if (simulation) run(*simulation);
  return simulation;
}

CaseInfo ligament_case() {
  return {"anatomy/1-ligament", "Springs between plates",
          "equilibrium of a rigid plate: p A = n k (h - slack), with h = V/A"};
}

TEST(Ligament, BalancesThePressureOnAPlate) {
  Case record(ligament_case());
  plan::SimulationSpec spec = make_plan({"plate"}, 0.3e-6);
  spec.ligaments = {make_ligament("septum", "", "", 100.0)};
  const auto simulation = run_plan({"plate"}, spec);
  ASSERT_TRUE(simulation);
  const double opening = 0.3e-6 / kArea;
  const double tension = kPoints * 100.0 * opening;
  record.record(
      {"pressure against 4 springs of 0.1 N/mm", "Pa", tension / kArea, simulation->report().mean_pressure, 2e-3});
  record.record({"tension of the springs", "N", tension, simulation->report().ligament_tension, 2e-3});
  record.record(
      {"length of the springs", "mm", 1e3 * opening, 1e3 * simulation->ligament_reports()[0].largest_length, 2e-3});
}

TEST(Ligament, IsSlackAtFirst) {
  Case record(ligament_case());
  plan::SimulationSpec spec = make_plan({"plate"}, 0.3e-6);
  spec.ligaments = {make_ligament("septum", "", "", 100.0)};
  spec.ligaments[0].slack = 0.2e-3;
  const auto simulation = run_plan({"plate"}, spec);
  ASSERT_TRUE(simulation);
  const double expected = kPoints * 100.0 * (0.3e-6 / kArea - 0.2e-3) / kArea;
  record.record({"pressure with 0.2 mm of slack", "Pa", expected, simulation->report().mean_pressure, 2e-3});
}

TEST(Ligament, BreaksForGood) {
  Case record(ligament_case());
  plan::SimulationSpec spec = make_plan({"plate"}, 0.3e-6);
  spec.ligaments = {make_ligament("septum", "", "", 100.0)};
  spec.ligaments[0].breaking_force = 100.0 * 0.3e-3;  // it breaks at 0.3 mm of the 0.52 it would open
  auto simulation = make_simulation(make_plates({"plate"}), spec);
  ASSERT_TRUE(simulation);
  double largest = 0.0;
  while (simulation->phase() == simulation::Phase::kRunning) {
    simulation->advance_step();
    largest = std::max(largest, simulation->report().ligament_tension);
  }
  const double per_step = 100.0 * 0.02 * 0.3e-6 / kArea;  // more than the limit by at most a step's opening
  record.record(
      {"largest tension of a point that breaks at 0.03 N", "N", 0.03, largest / kPoints, per_step, Bound::kAbsolute});
  record.record({"broken points of 4", "1", 4.0, static_cast<double>(simulation->report().broken_ligament_points), 0.0,
                 Bound::kAbsolute});
  record.record(
      {"pressure after all points broke", "Pa", 0.5, simulation->report().mean_pressure, 0.0, Bound::kAtMost});
}

TEST(ConnectiveTissue, PullsInProportionToTheThickness) {
  Case record({"anatomy/2-connective-tissue", "Fibres that join the walls of a film",
               "a rigid plate on distributed springs: p = k h, with h = V/A"});
  plan::SimulationSpec spec = make_plan({"plate"}, 0.3e-6);
  spec.films[0].connective_tissue.stiffness = 5e5;
  const auto simulation = run_plan({"plate"}, spec);
  ASSERT_TRUE(simulation);
  record.record({"pressure against 0.5 kPa/mm", "Pa", 5e5 * 0.3e-6 / kArea, simulation->report().mean_pressure, 2e-3});
}

TEST(TwoFilms, StandInSeries) {
  Case record({"anatomy/3-two-films", "Two films in series",
               "equilibrium of two rigid plates: springs across each film and one ligament across both"});
  const double volume = 0.2e-6;
  plan::SimulationSpec spec = make_plan({"upper", "lower"}, volume);
  spec.injections[1].volume = 2.0 * volume;
  spec.ligaments = {make_ligament("outer", "film_upper", "", 100.0), make_ligament("inner", "film_lower", "", 200.0),
                    make_ligament("through", "film_upper", "film_lower", 50.0)};
  const auto simulation = run_plan({"upper", "lower"}, spec);
  ASSERT_TRUE(simulation);
  const double outer = volume / kArea;
  const double inner = 2.0 * volume / kArea;
  const double through = 50.0 * (outer + inner);
  const auto zones = simulation->zone_reports();
  record.record(
      {"pressure of the outer film", "Pa", kPoints * (100.0 * outer + through) / kArea, zones[0].mean_pressure, 2e-3});
  record.record(
      {"pressure of the inner film", "Pa", kPoints * (200.0 * inner + through) / kArea, zones[1].mean_pressure, 2e-3});
  record.record({"tension of the ligament across both films", "N", kPoints * through,
                 simulation->ligament_reports()[2].tension, 2e-3});
}

}  // namespace
}  // namespace lipofill::verification
