// Cells that close and open, and pools that come to the suction limit.

#include "core/equilibrium/contact.h"

#include "tests/unit/equilibrium/small_equilibrium.h"

namespace lipofill::equilibrium {
namespace {

/// The bent shape has gaps of both signs.
struct Bent : SmallEquilibrium {
  StaticBalance balance = make_balance();
  Shape shape = bent_shape(0.0);
  PoolTarget target = with(0.0);

  /// Moves the outer wall of the film towards the inner one by `depth` [m] in the middle.
  void press(double depth) {
    const std::vector<int>& dofs = system->tissue().dof_of_component();
    const coupling::WallNodes& walls = system->setup().walls[0];
    for (const int node : walls.outer) {
      const Eigen::Vector3d x = system->rest_positions().col(node) - Eigen::Vector3d(0.024, 0.024, 0.0);
      const int dof = dofs[3 * static_cast<size_t>(node) + 2];
      if (dof >= 0) shape.displacement[dof] = -depth * std::exp(-x.head<2>().squaredNorm() / 5e-5);
    }
    balance.bring_to(shape, springs);
  }
};

TEST(ActiveSets, CellsCloseWhereTheGapIsNegative) {
  Bent c;
  c.press(0.2e-3);
  ASSERT_TRUE(update_active_sets(c.balance, c.pools, c.target, true, c.shape));
  ASSERT_FALSE(c.shape.closed.empty());
  ASSERT_LT(c.shape.closed.size(), 36u);
  for (int cell = 0; cell < 36; ++cell) {
    const bool is_closed = std::binary_search(c.shape.closed.begin(), c.shape.closed.end(), cell);
    EXPECT_EQ(is_closed, c.balance.gap()[cell] < 0.0) << cell;
  }
  EXPECT_EQ(c.shape.n_rows(), 1 + static_cast<Eigen::Index>(c.shape.closed.size()));
  EXPECT_FALSE(update_active_sets(c.balance, c.pools, c.target, true, c.shape)) << "nothing has changed since";
}

TEST(ActiveSets, CellsOpenThatTheirContactPullsAt) {
  Bent c;
  c.press(0.0);
  c.shape.closed = {3, 7};
  c.shape.pressure = Eigen::Vector3d(10.0, -1.0, 4.0);
  Shape held = c.shape;
  EXPECT_FALSE(update_active_sets(c.balance, c.pools, c.target, false, held)) << "cells only close";
  ASSERT_TRUE(update_active_sets(c.balance, c.pools, c.target, true, c.shape));
  EXPECT_EQ(c.shape.closed, std::vector<int>{7});
  EXPECT_EQ(c.shape.pressure, Eigen::Vector2d(10.0, 4.0));
}

TEST(ActiveSets, APoolComesToTheLimitAndLeavesIt) {
  Bent c;
  c.press(0.0);
  c.target.lowest_head = -100.0;
  c.shape.pressure[0] = -150.0;
  ASSERT_TRUE(update_active_sets(c.balance, c.pools, c.target, true, c.shape));
  EXPECT_EQ(c.shape.is_at_limit[0], 1);
  EXPECT_EQ(c.shape.pressure[0], -100.0);
  c.shape.pressure[0] = -150.0;
  EXPECT_NEAR(find_missing(c.balance, c.pools, c.target, c.shape)[0], 50.0, 1e-12) << "of pressure";
  c.target.volume[0] *= 1.5;
  ASSERT_TRUE(update_active_sets(c.balance, c.pools, c.target, true, c.shape));
  EXPECT_EQ(c.shape.is_at_limit[0], 0) << "its fat overfills the gap";
}

TEST(ActiveSets, RowsLackWhatTheGapDoes) {
  Bent c;
  c.press(0.1e-3);
  c.shape.closed = {21};
  c.shape.pressure = Eigen::Vector2d(0.0, 1.0);
  const Eigen::VectorXd missing = find_missing(c.balance, c.pools, c.with(1e-7), c.shape);
  EXPECT_NEAR(missing[0], c.with(1e-7).volume[0] - c.balance.gap().sum(), 1e-20);
  EXPECT_EQ(missing[1], -c.balance.gap()[21]);
}

}  // namespace
}  // namespace lipofill::equilibrium
