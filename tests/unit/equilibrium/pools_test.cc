// Which cells share a head: those that open edges and leaky walls connect.

#include "core/equilibrium/pools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::equilibrium {
namespace {

using geometry::ChartBox;
using geometry::ChartPoint;
using ::testing::ElementsAre;

/// 6 x 6 cells between the layers of the small plan.
struct Case {
  std::shared_ptr<const model::FaceModel> model = simulation::make_small_model();
  std::vector<plan::FilmSpec> specs{simulation::make_small_plan().films[0]};

  Pools find(const std::vector<Eigen::VectorXd>& entered = {}) const {
    std::vector<plan::FilmLayout> films;
    for (const plan::FilmSpec& spec : specs) {
      const auto film = plan::place_film(*model, spec);
      EXPECT_TRUE(film.ok()) << film.status();
      films.push_back(*film);
    }
    return find_pools(films, mechanics::number_cells(films), entered);
  }
  int cells_of(const Pools& pools, int pool) const {
    return static_cast<int>(std::count(pools.of_cell.begin(), pools.of_cell.end(), pool));
  }
  void part_in_the_middle(double leakage) {
    specs[0].walls.push_back({"wall", {ChartPoint{0.5, 0.0}, ChartPoint{0.5, 1.0}}, {}, leakage});
  }
};

TEST(Pools, AZoneInOnePieceIsOne) {
  const Case c;
  const Pools pools = c.find();
  EXPECT_THAT(pools.names, ElementsAre("all"));
  EXPECT_EQ(c.cells_of(pools, 0), 36);
}

/// A front that has come as far as the first two rows.
TEST(Pools, ACellThatFatHasYetToEnterIsOneOfItsOwn) {
  const Case c;
  Eigen::VectorXd entered = Eigen::VectorXd::Zero(36);
  entered.head(12).setOnes();
  const Pools pools = c.find({entered});
  EXPECT_EQ(pools.n(), 1 + 24);
  EXPECT_EQ(c.cells_of(pools, 0), 12);
  EXPECT_EQ(c.cells_of(pools, 1), 1);
  EXPECT_EQ(c.find({Eigen::VectorXd()}).n(), 1) << "no entry pressure";
}

TEST(Pools, ATightWallPartsAZone) {
  Case c;
  c.part_in_the_middle(0.0);
  const Pools pools = c.find();
  EXPECT_THAT(pools.names, ElementsAre("all", "all"));
  EXPECT_EQ(c.cells_of(pools, 0), 18);
  EXPECT_EQ(pools.of_cell[0], 0);
  EXPECT_EQ(pools.of_cell[5], 1);
}

TEST(Pools, ALeakyWallDoesNot) {
  Case c;
  c.part_in_the_middle(1e-9);
  EXPECT_THAT(c.find().names, ElementsAre("all"));
}

TEST(Pools, ZonesAreSealedUnlessTheirBorderLeaks) {
  Case c;
  c.specs[0].zones = {{"left", ChartBox{0.0, 0.5, 0.0, 1.0}}, {"right", ChartBox{0.5, 1.0, 0.0, 1.0}}};
  EXPECT_THAT(c.find().names, ElementsAre("left", "right"));
  c.specs[0].walls.push_back({"border", {}, {"left", "right"}, 1e-9});
  EXPECT_THAT(c.find().names, ElementsAre("left + right"));
}

TEST(Pools, AZoneInTwoPiecesIsTwo) {
  Case c;
  geometry::ScalarField cover;
  cover.n_xi = 4;
  cover.n_eta = 1;
  cover.values = {1.0, 0.0, 0.0, 1.0};
  c.specs[0].zones = {{"apart", plan::PaintedRegion{cover}}};
  EXPECT_THAT(c.find().names, ElementsAre("apart", "apart"));
}

TEST(Pools, FilmsWithWallsOfTheirOwnHaveNone) {
  Case c;
  c.specs.insert(c.specs.begin(), c.specs[0]);
  c.specs[0].name = "rigid";
  c.specs[0].below_layer.clear();
  c.specs[0].wall = plan::FilmWallKind::kRigid;
  const Pools pools = c.find();
  EXPECT_EQ(pools.n(), 1);
  EXPECT_EQ(pools.n_cells(), 36) << "as the gap system counts them";
}

TEST(Pools, SumsRunOverTheirCells) {
  Case c;
  c.part_in_the_middle(0.0);
  const Pools pools = c.find();
  const Eigen::VectorXd sums = pools.sum(Eigen::VectorXd::LinSpaced(36, 0.0, 35.0));
  EXPECT_EQ(sums.sum(), 630.0);
  EXPECT_EQ(sums[1] - sums[0], 54.0) << "each cell on the right is three further than its mirror";
}

}  // namespace
}  // namespace lipofill::equilibrium
