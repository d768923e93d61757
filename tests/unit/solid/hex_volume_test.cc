#include "core/solid/hex_volume.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "core/solid/hex_shape.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

/// By 2 x 2 x 2 Gauss points, which integrate a trilinear hexahedron's Jacobian exactly.
double integrate(const HexMesh& mesh, int material) {
  double volume = 0.0;
  for (int e = 0; e < mesh.n_hexahedra(); ++e) {
    if (mesh.material[e] != material) continue;
    for (const LocalPoint& point : hex_gauss_points()) {
      volume += compute_jacobian(mesh.gather(e, mesh.rest_positions), point).determinant();
    }
  }
  return volume;
}

TEST(HexVolume, IsTheIntegralOfTheJacobianForEachMaterial) {
  const Box box{{3, 4, 2}, {0.03, 0.05, 0.01}};
  HexMesh mesh = box.make();
  Jitter jitter(8);
  for (int a = 0; a < mesh.n_nodes(); ++a) mesh.rest_positions.col(a) += 2e-3 * jitter.next_vector();
  for (size_t e = 12; e < 24; ++e) mesh.material[e] = 2;
  const std::vector<double> volumes = compute_volumes(mesh, mesh.rest_positions, 3);
  ASSERT_EQ(volumes.size(), 3u);
  EXPECT_NEAR(volumes[0], integrate(mesh, 0), 1e-12 * volumes[0]);
  EXPECT_EQ(volumes[1], 0.0);
  EXPECT_NEAR(volumes[2], integrate(mesh, 2), 1e-12 * volumes[2]);
}

/// Far from the origin, as in a scan's frame.
TEST(HexVolume, DoesNotDependOnThePlace) {
  const Box box{{2, 2, 2}, {0.01, 0.01, 0.01}};
  const HexMesh mesh = box.make();
  const Eigen::Matrix3Xd far = mesh.rest_positions.colwise() + Eigen::Vector3d(10.0, -20.0, 30.0);
  EXPECT_NEAR(compute_volumes(mesh, far, 1)[0], 1e-6, 1e-18);
}

}  // namespace
}  // namespace lipofill::solid::testing
