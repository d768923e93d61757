// Patch tests (verification case 8): a state of constant stress, or of constant moment, prescribed
// on the rim of an irregular mesh is the solution inside. The solid-shell passes both on meshes
// distorted in the plane, with its faces free; on meshes distorted in space it is not meant to
// pass. EAS-9 passes the constant stress patch on meshes distorted in space.

#include <gtest/gtest.h>

#include "tests/unit/solid/box_mesh.h"
#include "tests/verification/record.h"
#include "tests/verification/solid/static_solver.h"

namespace lipofill::solid::testing {
namespace {

using verification::Bound;
using verification::Case;

constexpr double kNu = 0.45;
const ElasticMaterial kMaterial{2e5, kNu, 1100.0};

using Held = std::function<bool(const Box&, int i, int j, int k)>;

bool on_rim(const Box& box, int i, int j, int) {
  return i == 0 || j == 0 || i == box.n[0] || j == box.n[1];
}
bool on_surface(const Box& box, int i, int j, int k) {
  return on_rim(box, i, j, k) || k == 0 || k == box.n[2];
}

/// Largest error of the solution relative to the largest displacement.
void expect_exact(const char* name, const Box& box, const HexMesh& mesh, const Held& is_held,
                  const PointMap& displacement) {
  std::vector<bool> held(box.n_nodes());
  for_each_node(box, [&](int a, int i, int j, int k) { held[a] = is_held(box, i, j, k); });
  Eigen::Matrix3Xd exact(3, box.n_nodes());
  for (int a = 0; a < box.n_nodes(); ++a) exact.col(a) = displacement(mesh.rest_positions.col(a));
  Tissue tissue = Tissue::create(mesh, {kMaterial}, {}, {}).value();
  const Eigen::Matrix3Xd u = solve_prescribed(tissue, held, exact);
  const double error = (u - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
  Case patch({"solid/8a-patch", "Patch tests on irregular meshes", "The prescribed state itself is the solution."});
  patch.record({name, "1", 1e-12, error, 0.0, Bound::kAtMost});
}

Box plate_box() {
  return {{4, 3, 1}, {0.04, 0.03, 0.002}};
}

HexMesh irregular_plate(const Box& box) {
  HexMesh mesh = box.make();
  distort_in_plane(box, 0.3, 11, mesh);
  return mesh;
}

TEST(PatchTest, SolidShellMembrane) {
  // Plane stress: the free faces leave sigma_zz = 0, so the thickness strain follows from the
  // others.
  const double exx = 1e-3;
  const double eyy = -0.4e-3;
  const double gxy = 0.7e-3;
  const double ezz = -kNu / (1.0 - kNu) * (exx + eyy);
  const PointMap stretch = [=](const Eigen::Vector3d& X) {
    return Eigen::Vector3d(exx * X[0] + 0.5 * gxy * X[1], 0.5 * gxy * X[0] + eyy * X[1], ezz * X[2]);
  };
  const Box box = plate_box();
  expect_exact("solid-shell, membrane: error", box, irregular_plate(box), on_rim, stretch);
}

TEST(PatchTest, SolidShellBending) {
  // Constant curvatures kx, ky, kxy about the mid-plane z = 0; the faces are free, so the thickness
  // strain is linear in z.
  const double kx = 0.5;
  const double ky = -0.2;
  const double kxy = 0.3;
  const Box box = plate_box();
  const double middle = 0.5 * box.size[2];
  const PointMap bend = [=](const Eigen::Vector3d& X) {
    const double x = X[0];
    const double y = X[1];
    const double z = X[2] - middle;
    const double w = 0.5 * (kx * x * x + ky * y * y) + kxy * x * y + 0.5 * kNu / (1.0 - kNu) * (kx + ky) * z * z;
    return Eigen::Vector3d(-z * (kx * x + kxy * y), -z * (kxy * x + ky * y), w);
  };
  expect_exact("solid-shell, bending: error", box, irregular_plate(box), on_rim, bend);
}

TEST(PatchTest, IncompatibleModesInSpace) {
  Eigen::Matrix3d gradient;
  gradient << 1.0, -0.3, 0.4, 0.2, -0.7, 0.5, 0.1, 0.6, 0.3;
  const PointMap linear = [&](const Eigen::Vector3d& X) -> Eigen::Vector3d { return 1e-3 * gradient * X; };
  const Box box{{3, 4, 3}, {0.01, 0.02, 0.015}, true};
  HexMesh mesh = box.make();
  distort_inside(box, 0.3, 12, mesh);
  expect_exact("incompatible modes, distorted in space: error", box, mesh, on_surface, linear);
}

}  // namespace
}  // namespace lipofill::solid::testing
