#include "core/geometry/grid_volume.h"

#include <gtest/gtest.h>

#include <functional>

namespace lipofill::geometry {
namespace {

/// One layer of 2 x 1 hexahedra whose nodes are at a place of (i, j, level).
LayeredGrid make_grid(const std::function<Eigen::Vector3d(int, int, int)>& place) {
  LayeredGrid grid;
  grid.n_xi = 2;
  grid.n_eta = 1;
  grid.elements_through = {1};
  grid.nodes.resize(3, 12);
  for (int level = 0; level < 2; ++level) {
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 3; ++i) grid.nodes.col(grid.node(level, i, j)) = place(i, j, level);
    }
  }
  return grid;
}

TEST(GridVolume, AShearKeepsIt) {
  const LayeredGrid grid = make_grid([](int i, int j, int level) {
    return Eigen::Vector3d(0.01 * i + 0.004 * j, 0.01 * j + 0.002 * level, -0.003 * level);
  });
  EXPECT_NEAR(compute_grid_volume(grid), 0.6e-6, 1e-18);
}

/// A frustum: h/3 (A + B + sqrt(A B)), with sides of 2 and 1 below 4 and 2.
TEST(GridVolume, IsExactWhereSidesTaper) {
  const LayeredGrid grid = make_grid([](int i, int j, int level) {
    const double scale = level == 0 ? 2.0 : 1.0;
    return Eigen::Vector3d(scale * (i - 1), scale * (j - 0.5), -3.0 * level);
  });
  EXPECT_NEAR(compute_grid_volume(grid), 3.0 / 3.0 * (8.0 + 2.0 + 4.0), 1e-12);
}

TEST(GridVolume, IsNothingWithoutLayers) {
  LayeredGrid grid;
  grid.n_xi = grid.n_eta = 1;
  grid.nodes = Eigen::Matrix3Xd::Random(3, 4);
  EXPECT_EQ(compute_grid_volume(grid), 0.0);
}

}  // namespace
}  // namespace lipofill::geometry
