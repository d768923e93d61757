// Any rigid motion of any mesh: the internal force is nothing beside that of a 1 % stretch
// (verification case 8).

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/solid/tissue.h"
#include "tests/unit/solid/box_mesh.h"
#include "tests/verification/record.h"

namespace lipofill::solid::testing {
namespace {

using verification::Bound;
using verification::Case;

HexMesh irregular_slab(bool stacked) {
  const Box box{{5, 4, 3}, {0.05, 0.04, 0.009}, stacked};
  HexMesh mesh = box.make();
  distort_inside(box, 0.25, 21, mesh);
  return mesh;
}

Case make_case() {
  return Case({"solid/8b-rotation", "Rigid motions of an irregular slab",
               "None: no internal force, and a turned force of a turned deformation."});
}

void expect_no_force(const char* name, bool stacked) {
  const HexMesh mesh = irregular_slab(stacked);
  Tissue tissue = Tissue::create(mesh, {{1e5, 0.49, 1000.0}}, {}, {}).value();
  tissue.assemble(1.01 * mesh.rest_positions, 0.01);
  const double reference = tissue.internal_force().norm();
  Jitter jitter(22);
  double worst = 0.0;
  for (int k = 0; k <= 40; ++k) {
    const Eigen::AngleAxisd turn(M_PI * k / 20.0, jitter.next_vector().normalized());
    const Eigen::Vector3d shift = 0.3 * jitter.next_vector();
    const Eigen::Matrix3Xd x = (turn.toRotationMatrix() * mesh.rest_positions).colwise() + shift;
    tissue.assemble(x, 0.01);
    worst = std::max(worst, tissue.internal_force().norm() / reference);
    EXPECT_NEAR(tissue.min_volume_ratio(), 1.0, 1e-12);
  }
  make_case().record({name, "1", 1e-10, worst, 0.0, Bound::kAtMost});
}

TEST(RigidRotation, LeavesTheSolidShellAtRest) {
  expect_no_force("solid-shell: force relative to that of a 1 % stretch", false);
}

TEST(RigidRotation, LeavesIncompatibleModesAtRest) {
  expect_no_force("incompatible modes: force relative to that of a 1 % stretch", true);
}

/// A turned tissue answers as it does unturned, only turned.
TEST(RigidRotation, TurnsTheForceOfADeformation) {
  const HexMesh mesh = irregular_slab(false);
  Tissue tissue = Tissue::create(mesh, {{1e5, 0.45, 1000.0}}, {}, {}).value();
  Eigen::Matrix3Xd x = mesh.rest_positions;
  Jitter jitter(23);
  for (int a = 0; a < x.cols(); ++a) x.col(a) += 4e-4 * jitter.next_vector();
  tissue.assemble(x, 0.01);
  const Eigen::Matrix3Xd force = tissue.internal_force().reshaped(3, x.cols());
  const double energy = tissue.elastic_energy();
  const Eigen::Matrix3d R = Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, -1, 2).normalized()).toRotationMatrix();
  tissue.assemble(R * x, 0.01);
  const double difference = (tissue.internal_force().reshaped(3, x.cols()) - R * force).norm() / force.norm();
  Case turned = make_case();
  turned.record({"force of a turned deformation: difference", "1", 1e-11, difference, 0.0, Bound::kAtMost});
  turned.record({"energy of a turned deformation", "J", energy, tissue.elastic_energy(), 1e-12});
}

}  // namespace
}  // namespace lipofill::solid::testing
