#include "core/planning/plan_parts.h"

#include <gmock/gmock.h>

#include "tests/unit/planning/square_case.h"

namespace lipofill::planning {
namespace {

using ::testing::ElementsAre;

/// A part with cells at these places of a line [m].
PartPlace make_part(const std::vector<double>& places, std::vector<int> skin = {}) {
  PartPlace part;
  part.skin = std::move(skin);
  part.fat.setZero(3, static_cast<Eigen::Index>(places.size()));
  for (size_t k = 0; k < places.size(); ++k) part.fat(0, static_cast<Eigen::Index>(k)) = places[k];
  return part;
}

TEST(PlanParts, TouchWhereZonesComeNear) {
  const std::vector<PartPlace> parts = {make_part({0.000, 0.005}), make_part({0.100}), make_part({0.016, 0.030}),
                                        make_part({0.041})};
  EXPECT_NEAR(find_distance(parts[0], parts[2]), 0.011, 1e-12);
  EXPECT_THAT(group_touching(parts), ElementsAre(0, 1, 0, 0)) << "the last touches the first through the third";
  EXPECT_NEAR(find_widest_gap({parts[0], parts[2], parts[3]}), 0.011, 1e-12);
  EXPECT_THAT(group_touching({make_part({0.0}), make_part({})}), ElementsAre(0, 1)) << "nothing to touch with";
}

TEST(PlanParts, JoinThroughALaterOne) {
  EXPECT_THAT(group_touching({make_part({0.0}), make_part({0.02}), make_part({0.01})}), ElementsAre(0, 0, 0));
}

TEST(PlanParts, CountTheVerticesOfBoth) {
  EXPECT_EQ(count_shared_vertices(make_part({}, {1, 4, 7}), make_part({}, {0, 4, 7, 9})), 2);
}

// Zones of a plate of 48 mm that end at 0.45 and begin at 0.55 of its width, 4.8 mm apart: cells
// are 4 mm wide, and the outlines cut them.
TEST(PlanParts, ArePlacedOnTheSkin) {
  const auto model = make_square();
  plan::SimulationSpec left = make_square_plan(1e-6, 1e-6), right = left;
  left.films[0].zones.pop_back();
  left.injections.pop_back();
  right.films[0].zones.erase(right.films[0].zones.begin());
  right.injections.erase(right.injections.begin());
  const auto one = place_part(*model, left);
  const auto other = place_part(*model, right);
  ASSERT_TRUE(one.ok() && other.ok()) << one.status() << other.status();
  EXPECT_NEAR(one->fat.row(2).cwiseAbs().maxCoeff(), 0.0, 1e-12) << "the skin lies at z = 0";
  EXPECT_NEAR(find_distance(*one, *other), 4.8e-3, 4e-3);
  EXPECT_GE(one->fat.row(0).minCoeff(), 0.1 * 48e-3 - 2e-3);
  EXPECT_LE(other->fat.row(0).maxCoeff(), 0.9 * 48e-3 + 2e-3);
}

}  // namespace
}  // namespace lipofill::planning
