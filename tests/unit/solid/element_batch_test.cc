#include "core/solid/element_batch.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cstring>

#include "core/solid/rotation.h"
#include "core/solid/solid_shell.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

/// Four hexahedra in a row.
struct Row {
  Box box{{kLanes, 1, 1}, {0.02, 0.004, 0.002}};
  HexMesh mesh = box.make();
  HexStiffness K;
  ElementBatch batch;

  Row() {
    for (int lane = 0; lane < kLanes; ++lane) {
      const HexNodes nodes = mesh.gather(lane, mesh.rest_positions);
      K = compute_solid_shell_stiffness(nodes, compute_elasticity_matrix({1e5, 0.45, 1000.0}));
      batch.set_lane(lane, mesh.hexahedra[lane], nodes, K);
    }
  }

  Eigen::Matrix3Xd shaken(double amplitude, unsigned seed) const {
    Jitter jitter(seed);
    Eigen::Matrix3Xd x = mesh.rest_positions;
    for (int a = 0; a < x.cols(); ++a) x.col(a) += amplitude * jitter.next_vector();
    return x;
  }

  Eigen::Matrix3d deformation_gradient(int lane, const Eigen::Matrix3Xd& x) const {
    const LocalPoint centre = LocalPoint::Zero();
    return compute_jacobian(mesh.gather(lane, x), centre) *
           compute_jacobian(mesh.gather(lane, mesh.rest_positions), centre).inverse();
  }
};

TEST(ElementBatch, WiderRegistersGiveTheSameBits) {
  const Row row;
  for (const double amplitude : {0.0, 1e-4, 1e-3, 3e-3}) {
    const Eigen::Matrix3Xd x = row.shaken(amplitude, 4);
    BatchResult wide;
    BatchResult portable;
    compute_batch(row.batch, x, wide);
    compute_batch_portable(row.batch, x, portable);
    EXPECT_EQ(std::memcmp(&wide, &portable, sizeof wide), 0) << amplitude;
  }
}

/// Blocks and forces against R K R^T with the rotation of compute_nearest_rotation, also where elements are crushed or
/// turned inside out.
TEST(ElementBatch, MatchesTheDefinition) {
  const Row row;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const Eigen::Matrix3Xd x = row.shaken(seed <= 15 ? 2e-4 : 3e-3, seed);
    BatchResult result;
    compute_batch(row.batch, x, result);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Eigen::Matrix3d F = row.deformation_gradient(lane, x);
      EXPECT_NEAR(result.volume_ratio[lane], F.determinant(), 1e-11 * (1.0 + F.squaredNorm() * F.norm()));
      const Eigen::Matrix3d R = compute_nearest_rotation(F);
      HexNodes d = R.transpose() * row.mesh.gather(lane, x) - row.mesh.gather(lane, row.mesh.rest_positions);
      const Eigen::Matrix<double, 24, 1> f = row.K * Eigen::Map<const Eigen::Matrix<double, 24, 1>>(d.data());
      for (int a = 0; a < 8; ++a) {
        const Eigen::Vector3d expected = R * f.segment<3>(3 * a);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(result.force[a][c][lane], expected[c], 1e-8 * f.norm());
      }
      const Eigen::Matrix3d block = R * row.K.block<3, 3>(15, 6) * R.transpose();
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          EXPECT_NEAR(result.stiffness[node_pair(5, 2)].m[i][j][lane], block(i, j), 1e-8 * block.norm());
        }
      }
    }
  }
}

}  // namespace
}  // namespace lipofill::solid::testing
