// The corotational force leaves out how the rotations change with the positions, so it is not the
// exact slope of the energy: off by a share of the strain. The energy balance of a simulation is
// stated within that share.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/solid/tissue.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

constexpr double kStatic = std::numeric_limits<double>::infinity();

/// A plate, distorted in its plane, lifted to a dome, its fibres staying normal.
struct Dome {
  Box box{{8, 8, 1}, {0.04, 0.04, 0.002}};
  HexMesh mesh = box.make();
  Tissue tissue;

  Dome() : tissue(make()) {}

  Tissue make() {
    distort_in_plane(box, 0.2, 1, mesh);
    return Tissue::create(mesh, {{1e5, 0.49, 1000.0}}, {}, {}).value();
  }

  Eigen::Matrix3Xd lifted(double height) const {
    Eigen::Matrix3Xd x = mesh.rest_positions;
    const double k = 2.0 * std::numbers::pi / box.size[0];
    for (int a = 0; a < x.cols(); ++a) {
      const double p = k * x(0, a);
      const double q = k * x(1, a);
      const Eigen::Vector3d normal(-0.25 * height * k * std::sin(p) * (1.0 - std::cos(q)),
                                   -0.25 * height * k * std::sin(q) * (1.0 - std::cos(p)), 1.0);
      const double z = x(2, a) - 0.5 * box.size[2];
      const Eigen::Vector3d middle(x(0, a), x(1, a), 0.25 * height * (1.0 - std::cos(p)) * (1.0 - std::cos(q)));
      x.col(a) = middle + z * normal.normalized();
    }
    return x;
  }

  /// |slope of the energy - force| over |force|.
  double force_error(double height) {
    const Eigen::Matrix3Xd x = lifted(height);
    Eigen::VectorXd slope(x.size());
    const double h = 1e-8;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      Eigen::Matrix3Xd moved = x;
      moved.data()[i] += h;
      tissue.assemble(moved, kStatic);
      slope[i] = tissue.elastic_energy();
      moved.data()[i] -= 2.0 * h;
      tissue.assemble(moved, kStatic);
      slope[i] = (slope[i] - tissue.elastic_energy()) / (2.0 * h);
    }
    tissue.assemble(x, kStatic);
    return (slope - tissue.internal_force()).norm() / tissue.internal_force().norm();
  }

  /// Work of the internal force along the way up, over the energy at its end.
  double work_over_energy(double height) {
    constexpr int kSteps = 100;
    double work = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      const Eigen::Matrix3Xd step = lifted(height * (k + 1) / kSteps) - lifted(height * k / kSteps);
      tissue.assemble(lifted(height * (k + 0.5) / kSteps), kStatic);
      work += tissue.internal_force().dot(Eigen::Map<const Eigen::VectorXd>(step.data(), step.size()));
    }
    tissue.assemble(lifted(height), kStatic);
    return work / tissue.elastic_energy();
  }
};

TEST(TissueEnergy, SlopeIsTheForceUpToAShareOfTheStrain) {
  Dome dome;
  const double low = dome.force_error(0.002);
  const double high = dome.force_error(0.004);
  EXPECT_LT(low, 1e-3);
  EXPECT_LT(high, 2e-3);
  EXPECT_GT(high, low);
}

/// A dome twice as high as the plate is thick.
TEST(TissueEnergy, IsTheWorkDoneWithinAPercent) {
  Dome dome;
  EXPECT_NEAR(dome.work_over_energy(0.002), 1.0, 0.002);
  EXPECT_NEAR(dome.work_over_energy(0.004), 1.0, 0.005);
}

}  // namespace
}  // namespace lipofill::solid::testing
