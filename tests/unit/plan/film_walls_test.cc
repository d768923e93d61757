// Which neighbouring slots the walls of a film part, and how much seeps through them.

#include "core/plan/film_walls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/field_violations.h"
#include "core/plan/film_layout.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::plan {
namespace {

using geometry::ChartPoint;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

/// 6 x 4 slots over the square of 48 mm, so that a slot is 8 mm wide along xi and 12 mm along eta;
/// rows 0 and 1 are zone 0, the others zone 1.
struct Case {
  std::shared_ptr<const model::FaceModel> model = simulation::make_small_model();
  FilmSpec spec = simulation::make_small_plan().films[0];
  std::vector<int> zone_of_slot;

  Case() {
    spec.n_eta = 4;
    spec.zones = {{"low", ChartBox{0.0, 1.0, 0.0, 0.5}}, {"high", ChartBox{0.0, 1.0, 0.5, 1.0}}};
    for (int slot = 0; slot < 24; ++slot) zone_of_slot.push_back(slot < 12 ? 0 : 1);
  }

  void add_path(std::vector<geometry::SkinPoint> path, double leakage = 0.0) {
    spec.walls.push_back({"wall", std::move(path), {}, leakage});
  }
  void add_border(const std::string& first, const std::string& second, double leakage = 0.0) {
    spec.walls.push_back({"wall", {}, {first, second}, leakage});
  }
  PlacedWalls place() const {
    const auto placed = place_walls(*model, spec, zone_of_slot);
    EXPECT_TRUE(placed.ok()) << placed.status();
    return placed.ok() ? *placed : PlacedWalls();
  }
  /// The one thing wrong, as "field: description".
  std::string refusal() const {
    const std::vector<FieldViolation> all = field_violations_of(place_walls(*model, spec, zone_of_slot).status());
    EXPECT_EQ(all.size(), 1u);
    return all.empty() ? "" : all[0].field + ": " + all[0].description;
  }
};

TEST(FilmWalls, APathPartsTheSlotsOnItsTwoSides) {
  Case c;
  c.add_path({ChartPoint{0.5, 0.0}, ChartPoint{0.5, 1.0}});
  const PlacedWalls placed = c.place();
  EXPECT_THAT(placed.inside_zones, ElementsAre(Pair(2, 3), Pair(8, 9), Pair(14, 15), Pair(20, 21)));
  EXPECT_TRUE(placed.leaky.empty()) << "the wall is tight";
}

TEST(FilmWalls, APathEndsWhereItsLastPointLies) {
  Case c;
  c.add_path({ChartPoint{0.5, 0.0}, ChartPoint{0.5, 0.3}});
  EXPECT_THAT(c.place().inside_zones, ElementsAre(Pair(2, 3)));
}

/// Centres at xi = 2.5/6: whichever side they count for, each row is parted once.
TEST(FilmWalls, APathThroughCentresPartsEachPairOnce) {
  Case c;
  c.add_path({ChartPoint{2.5 / 6.0, 0.0}, ChartPoint{2.5 / 6.0, 1.0}});
  const film::WalledSlots walls = c.place().inside_zones;
  ASSERT_EQ(walls.size(), 4u);
  int row = 0;
  for (const auto& [slot, next] : walls) {
    EXPECT_EQ(next, slot + 1);
    EXPECT_EQ(slot / 6, row++);
    EXPECT_TRUE(slot % 6 == 1 || slot % 6 == 2) << slot;
  }
}

/// Along the border of the zones a path parts nothing: the zones do that.
TEST(FilmWalls, APathIsForTheInsideOfZones) {
  Case c;
  c.add_path({ChartPoint{0.0, 0.5}, ChartPoint{1.0, 0.5}});
  EXPECT_THAT(c.refusal(), HasSubstr("walls[0]: parts no two cells"));
  c.spec.walls.clear();
  c.add_path({ChartPoint{0.0, 0.25}, ChartPoint{0.6, 0.25}, ChartPoint{0.6, 0.0}});
  const film::WalledSlots expected{{0, 6}, {1, 7}, {2, 8}, {3, 9}};  // the centre of column 3 is at 0.583
  film::WalledSlots across;
  for (const auto& wall : c.place().inside_zones) {
    if (wall.second == wall.first + 6) across.insert(wall);
  }
  EXPECT_EQ(across, expected);
}

TEST(FilmWalls, ABorderThatLeaksIsNoWallInsideAZone) {
  Case c;
  c.add_border("high", "low", 2e-9);
  const PlacedWalls placed = c.place();
  EXPECT_TRUE(placed.inside_zones.empty());
  ASSERT_EQ(placed.leaky.size(), 6u);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(placed.leaky[i].first, std::pair(6 + i, 12 + i));
    EXPECT_EQ(placed.leaky[i].second, 2e-9);
  }
}

TEST(FilmWalls, SlotsWithoutACellAreNotParted) {
  Case c;
  c.zone_of_slot[8] = c.zone_of_slot[21] = -1;
  c.add_path({ChartPoint{0.5, 0.0}, ChartPoint{0.5, 1.0}});
  EXPECT_THAT(c.place().inside_zones, ElementsAre(Pair(2, 3), Pair(14, 15)));
}

/// Conductance is leakage times the length of the side between the cells: 12 mm between neighbours
/// along xi, 8 mm along eta.
TEST(FilmWalls, WhatSeepsGoesWithTheLengthOfTheSide) {
  Case c;
  c.add_path({ChartPoint{0.5, 0.0}, ChartPoint{0.5, 1.0}}, 3e-9);
  c.add_border("low", "high", 5e-9);
  const PlacedWalls placed = c.place();
  const film::FilmGrid grid = film::make_film_grid(c.spec.extent, 6, 4, c.zone_of_slot, placed.inside_zones);
  const std::vector<film::LeakyWall> leaky = find_leaky_walls(c.model->geometry.grid, grid, placed);
  ASSERT_EQ(leaky.size(), 10u);
  for (const film::LeakyWall& wall : leaky) {
    const bool along_xi = wall.right == wall.left + 1;
    EXPECT_NEAR(wall.conductance, along_xi ? 3e-9 * 12e-3 : 5e-9 * 8e-3, 1e-22) << wall.left;
  }
}

TEST(FilmWalls, RefusesWhatIsNoWall) {
  Case c;
  c.add_path({ChartPoint{0.5, 0.5}});
  EXPECT_THAT(c.refusal(), HasSubstr("walls[0].path.points: are 1, must be 2 to 256"));
  c.spec.walls.clear();
  c.add_path({ChartPoint{0.5, 0.0}, ChartPoint{0.5, 1.0}}, -1e-9);
  EXPECT_THAT(c.refusal(), HasSubstr("walls[0].leakage_ml_per_s_kpa_cm: "));
  c.spec.walls.clear();
  c.add_path({ChartPoint{0.5, 0.0}, ChartPoint{0.5, 1.2}});
  EXPECT_THAT(c.refusal(), HasSubstr("walls[0].path.points[1]"));
  c.spec.walls.clear();
  c.add_border("low", "middle");
  EXPECT_THAT(c.refusal(), HasSubstr("walls[0].between.second: is 'middle'"));
  c.spec.walls.clear();
  c.add_path({ChartPoint{0.5, 0.1}, ChartPoint{0.5, 0.11}});
  EXPECT_THAT(c.refusal(), HasSubstr("walls[0]: parts no two cells"));
}

}  // namespace
}  // namespace lipofill::plan
