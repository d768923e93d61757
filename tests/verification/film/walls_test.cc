// Walls inside a film, and tissue that fat has to part before it enters.

#include <vector>

#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ChartBox;
using geometry::ChartPoint;
using geometry::ScalarField;
using plan::FilmWallKind;

constexpr double kStiffness = 1e6;  // the Winkler wall has it [Pa/m]

// Two chambers on a Winkler wall with a leaky wall between them: the pressure difference falls as
// exp(-t/tau), 1/tau = k L l (1/A1 + 1/A2), L the leakage and l the wall's length.
TEST(LeakyWall, LetsTwoChambersLevelAtItsRate) {
  Case record({"anatomy/4-leaky-wall", "Two chambers on a Winkler wall level through a leaky wall",
               "d(dp)/dt = -k L l (1/A1 + 1/A2) dp"});
  const double length = 0.03;
  const double width = 0.01;
  const double leakage = 2e-9;  // [m2/(Pa s)]
  plan::SimulationSpec spec;
  spec.films = {make_film(FilmWallKind::kWinkler, 3, 1)};
  spec.films[0].wall_stiffness = kStiffness;
  spec.films[0].rest_thickness = ScalarField::constant(0.1e-3);
  spec.films[0].initial_thickness = ScalarField{4, 1, {2e-3, 2e-3, 1e-3, 1e-3}};
  spec.films[0].zones = {{"one", ChartBox{0.0, 0.5, 0.0, 1.0}}, {"two", ChartBox{0.5, 1.0, 0.0, 1.0}}};
  spec.films[0].edge.outline = plan::ZoneOutline::kCells;
  spec.films[0].zones[0].shape = ChartBox{0.0, 0.34, 0.0, 1.0};
  spec.films[0].zones[1].shape = ChartBox{0.34, 1.0, 0.0, 1.0};
  spec.films[0].walls = {{"septum", {}, {"one", "two"}, leakage}};
  spec.fat_viscosity = 0.01;
  spec.step = 0.02;
  spec.end = 4.0;
  spec.settle_skin_speed = 0.0;
  auto simulation = make_simulation(make_bare_square(length, width), spec);
  ASSERT_TRUE(simulation);
  const double one = length * width / 3.0;
  const double rate = kStiffness * leakage * width * (1.0 / one + 0.5 / one);
  std::vector<double> time, measured, expected;
  const auto difference = [&] {
    const auto zones = simulation->zone_reports();
    return zones[0].volume / one - zones[1].volume / (2.0 * one);
  };
  const double start = difference();
  while (simulation->phase() == simulation::Phase::kRunning) {
    simulation->advance_step();
    time.push_back(simulation->report().time);
    measured.push_back(1e3 * difference());
    expected.push_back(1e3 * start * std::exp(-rate * time.back()));
  }
  const double fall = std::log(1e3 * start / measured.back()) / time.back();
  // Implicit Euler falls by log(1 + rate dt)/dt.
  record.record({"rate of levelling", "1/s", std::log(1.0 + rate * spec.step) / spec.step, fall, 5e-3});
  record.record_curve({"difference of thickness", "time [s]", "difference [mm]", time, measured, expected});
  EXPECT_LT(simulation->report().film_volume_relative_error, 1e-12);
}

// A wall across a zone seals one half from the other; one that ends halfway does not.
TEST(SealedWall, LeaksNothingAlongItsLength) {
  Case record(
      {"anatomy/5-sealed-wall", "A sealed wall through a zone", "no flux through it: the far half keeps its volume"});
  const auto far_side = [](double wall_end) {
    plan::SimulationSpec spec;
    spec.films = {make_film(FilmWallKind::kWinkler, 8, 8)};
    spec.films[0].wall_stiffness = kStiffness;
    spec.films[0].walls = {{"septum", {ChartPoint{0.5, 0.0}, ChartPoint{0.5, wall_end}}, {}, 0.0}};
    spec.fat_viscosity = 0.1;
    spec.injections = {{"all", 0.2e-6, 1e-6, 0.0, ChartPoint{0.2, 0.2}}};
    spec.probes = {{"near", "", ChartPoint{0.2, 0.2}}, {"far", "", ChartPoint{0.8, 0.2}}};
    spec.step = 0.05;
    spec.max_step = 60.0;
    spec.end = 20000.0;
    spec.settle_skin_speed = 0.0;
    auto simulation = make_simulation(make_bare_square(0.04, 0.04), spec);
    if (!simulation) return 0.0;
    run(*simulation);
    return simulation->report().probe_thickness[1];
  };
  record.record({"thickness beyond a whole wall", "mm", 0.05, 1e3 * far_side(1.0), 1e-14});
  record.record(
      {"thickness beyond half a wall, levelled", "mm", 0.05 + 0.2e-6 / (0.04 * 0.04) * 1e3, 1e3 * far_side(0.5), 1e-4});
}

// Fat of hardly any viscosity fills the open half of a channel until its pressure, k V/A, is the
// entry pressure; from then on it opens a cell whenever the pressure is there again.
TEST(EntryPressure, HoldsTheFrontUntilItIsReached) {
  Case record({"anatomy/6-entry-pressure", "A front waits for its entry pressure",
               "p = k Q t/A of the open part reaches p_e at t = p_e A/(k Q); then the open area is k Q t/p_e"});
  const int n = 40;
  const double length = 0.08;
  const double width = 4e-3;
  const double entry = 2000.0;
  const double rate = 2e-8;
  const double cell_area = length * width / n;
  plan::SimulationSpec spec;
  spec.films = {make_film(FilmWallKind::kWinkler, n, 1)};
  spec.films[0].wall_stiffness = kStiffness;
  spec.films[0].rest_thickness = ScalarField::constant(1e-3);
  ScalarField start{2 * n + 1, 1, {}};
  for (int i = 0; i <= 2 * n; ++i) start.values.push_back(i < 20 ? 1.000001e-3 : 1e-3);
  spec.films[0].initial_thickness = start;
  spec.films[0].connective_tissue.entry_pressure = entry;
  spec.injections = {{"all", rate * 24.0, rate, 0.0, ChartPoint{0.5 / n, 0.5}}};
  spec.fat_viscosity = 0.01;
  spec.step = 0.02;
  spec.end = 24.0;
  spec.settle_skin_speed = 0.0;
  auto simulation = make_simulation(make_bare_square(length, width), spec);
  ASSERT_TRUE(simulation);
  const int closed_at_first = simulation->report().closed_cells;
  EXPECT_EQ(closed_at_first, n - 10);
  double opened = 0.0;
  while (simulation->phase() == simulation::Phase::kRunning) {
    simulation->advance_step();
    if (opened == 0.0 && simulation->report().closed_cells < closed_at_first) opened = simulation->report().time;
  }
  record.record({"time when the front first moves", "s", entry * 10.0 * cell_area / (kStiffness * rate), opened, 0.02});
  const double open_cells = static_cast<double>(n - simulation->report().closed_cells);
  record.record({"open cells at the end", "1", kStiffness * rate * 24.0 / (entry * cell_area), open_cells, 1.0,
                 Bound::kAbsolute});
  EXPECT_LT(simulation->report().film_volume_relative_error, 1e-12);
}

}  // namespace
}  // namespace lipofill::verification
