// Draws of members, fields that are moved over the skin, and parts as bytes.

#include "core/forecast/member_run.h"

#include <gtest/gtest.h>

#include "core/forecast/part_bytes.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::forecast {
namespace {

TEST(MemberRun, DrawsFollowTheirDistributions) {
  const std::vector<UncertainInput> inputs = {
      {Quantity::kLayerModulus, "skin", Distribution::log_normal(1.0, 0.3), "", false},
      {Quantity::kZoneVolume, "all", {Law::kUniform, 0.0, 0.0, 0.9, 1.1}, "", false}};
  const Design design = draw_design(inputs, 511);
  Eigen::VectorXd first = design.values.col(0), second = design.values.col(1);
  EXPECT_NEAR(quantile_of(first, 0.95), inputs[0].distribution.quantile(0.95), 0.01);
  EXPECT_NEAR(quantile_of(second, 0.05), 0.91, 1e-3);
  EXPECT_EQ(design.is_gaussian, (std::vector<bool>{true, false}));
  EXPECT_LE(design.standard.col(1).cwiseAbs().maxCoeff(), 1.0);
}

/// On a plate of 48 mm with 12 hexahedra a side, 4 mm are one node.
TEST(MemberRun, FieldsMoveWithTheirZones) {
  const auto model = simulation::make_small_model();
  const geometry::LayeredGrid& grid = model->geometry.grid;
  Eigen::Matrix3Xf field = Eigen::Matrix3Xf::Zero(3, grid.nodes_per_level());
  field.col(grid.surface_index(5, 6)).z() = 2.0f;
  const Eigen::Matrix3Xf moved = move_over_skin(grid, field, 4e-3, -8e-3);
  EXPECT_NEAR(moved.col(grid.surface_index(6, 4)).z(), 2.0f, 1e-5);
  EXPECT_NEAR(moved.row(2).sum(), 2.0f, 1e-4);
  const Eigen::Matrix3Xf half = move_over_skin(grid, field, 2e-3, 0.0);
  EXPECT_NEAR(half.col(grid.surface_index(5, 6)).z(), 1.0f, 1e-5);
  EXPECT_NEAR(half.col(grid.surface_index(6, 6)).z(), 1.0f, 1e-5);
}

TEST(PartBytes, ComeBackToTheLastBitOrNotAtAll) {
  simulation::MemberResult failed{"a reason", {}}, settled;
  settled.shapes.push_back(
      {Eigen::Matrix3Xf::Random(3, 5), 0.1, 0.2, Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(3.0, 4.0)});
  const std::string bytes = write_part({failed, settled});
  const auto back = read_part(bytes, 2);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ((*back)[0].failure, "a reason");
  EXPECT_EQ((*back)[1].shapes[0].skin, settled.shapes[0].skin);
  EXPECT_EQ((*back)[1].shapes[0].volume, settled.shapes[0].volume);
  EXPECT_FALSE(read_part(bytes, 3).has_value());
  for (const size_t at : {3u, 70u, 100u}) {
    std::string damaged = bytes;
    damaged[at] ^= 1;
    EXPECT_FALSE(read_part(damaged, 2).has_value());
  }
  EXPECT_FALSE(read_part(bytes.substr(0, bytes.size() - 1), 2).has_value());
  EXPECT_FALSE(read_part("", 2).has_value());
}

}  // namespace
}  // namespace lipofill::forecast
