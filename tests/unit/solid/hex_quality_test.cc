#include "core/solid/hex_quality.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/solid/hex_shape.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

TEST(ScaledJacobian, CuboidIsOne) {
  const HexNodes nodes = Eigen::Vector3d(2.0, 0.3, 5.0).asDiagonal() * hex_corners();
  EXPECT_NEAR(compute_scaled_jacobian(nodes), 1.0, 1e-15);
}

TEST(ScaledJacobian, ShearedPrismIsTheSineOfItsAngle) {
  Eigen::Matrix3d shear = Eigen::Matrix3d::Identity();
  shear(0, 1) = 1.0 / std::tan(M_PI / 6.0);  // 30 degrees between xi and eta
  EXPECT_NEAR(compute_scaled_jacobian(shear * hex_corners()), 0.5, 1e-14);
}

TEST(ScaledJacobian, FoldedCornerIsNegative) {
  HexNodes nodes = hex_corners();
  nodes.col(6) = Eigen::Vector3d(-0.5, -0.5, 1.0);
  EXPECT_LT(compute_scaled_jacobian(nodes), 0.0);
  EXPECT_NEAR(compute_scaled_jacobian(Eigen::Vector3d(1, 1, -1).asDiagonal() * hex_corners()), -1.0, 1e-15);
}

TEST(ScaledJacobian, CollapsedAndNotFiniteAreTheWorst) {
  HexNodes nodes = hex_corners();
  nodes.col(1) = nodes.col(0);
  EXPECT_EQ(compute_scaled_jacobian(nodes), -1.0);
  nodes = hex_corners();
  nodes(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(compute_scaled_jacobian(nodes), -1.0);
}

TEST(MinScaledJacobian, FindsTheWorstAtThePositionsGiven) {
  const Box box{{3, 2, 1}, {3, 2, 1}};
  const HexMesh mesh = box.make();
  EXPECT_NEAR(compute_min_scaled_jacobian(mesh, mesh.rest_positions), 1.0, 1e-15);
  Eigen::Matrix3Xd x = mesh.rest_positions;
  x.col(box.node(3, 2, 1)) = Eigen::Vector3d(2.2, 1.1, 1.0);
  EXPECT_LT(compute_min_scaled_jacobian(mesh, x), 0.0);
}

/// Side by side as one by one, with lanes left over, a node on another and one nowhere.
TEST(MinScaledJacobian, IsTheLeastOfAll) {
  const Box box{{7, 3, 2}, {7, 3, 2}};
  HexMesh mesh = box.make();
  Jitter jitter(4);
  for (int k = 0; k < 8; ++k) {
    Eigen::Matrix3Xd x = mesh.rest_positions;
    for (int a = 0; a < x.cols(); ++a) x.col(a) += 0.05 * k * jitter.next_vector();
    if (k == 1) x.col(box.node(3, 1, 1)) = x.col(box.node(3, 2, 1));
    if (k == 2) x(1, box.node(7, 3, 2)) = std::numeric_limits<double>::quiet_NaN();
    double least = 1.0;
    for (int e = 0; e < mesh.n_hexahedra(); ++e) least = std::min(least, compute_scaled_jacobian(mesh.gather(e, x)));
    EXPECT_NEAR(compute_min_scaled_jacobian(mesh, x), least, 1e-14);
    EXPECT_EQ(least == -1.0, k == 1 || k == 2);
  }
}

}  // namespace
}  // namespace lipofill::solid::testing
