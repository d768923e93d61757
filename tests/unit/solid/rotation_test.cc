#include "core/solid/rotation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <limits>

#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

Eigen::Matrix3d random_rotation(Jitter& jitter) {
  const double angle = 3.14159 * jitter.next();
  return Eigen::AngleAxisd(angle, jitter.next_vector().normalized()).toRotationMatrix();
}

Eigen::Matrix3d random_matrix(Jitter& jitter) {
  Eigen::Matrix3d A;
  for (int c = 0; c < 3; ++c) A.col(c) = jitter.next_vector();
  return A;
}

void expect_proper(const Eigen::Matrix3d& R) {
  EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_NEAR(R.determinant(), 1.0, 1e-14);
}

TEST(NearestRotation, IsThePolarDecomposition) {
  Jitter jitter(1);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Matrix3d R = random_rotation(jitter);
    const Eigen::Matrix3d A = random_matrix(jitter);
    const Eigen::Matrix3d U = A.transpose() * A + 0.1 * Eigen::Matrix3d::Identity();
    EXPECT_LT((compute_nearest_rotation(R * U) - R).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(NearestRotation, NoOtherRotationIsNearer) {
  Jitter jitter(2);
  for (int k = 0; k < 50; ++k) {
    const Eigen::Matrix3d F = random_matrix(jitter);  // half of these are turned inside out
    const Eigen::Matrix3d R = compute_nearest_rotation(F);
    expect_proper(R);
    for (int trial = 0; trial < 50; ++trial) {
      EXPECT_LE((random_rotation(jitter).transpose() * F).trace(), (R.transpose() * F).trace() + 1e-12);
    }
  }
}

TEST(NearestRotation, StaysProperWhereFIsSingularOrMirrored) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 1, 0).normalized()).toRotationMatrix();
  for (const Eigen::Vector3d& stretch : {Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 0),
                                         Eigen::Vector3d(1, 1, -1e-9), Eigen::Vector3d(-1, -1, -1)}) {
    expect_proper(compute_nearest_rotation(R * stretch.asDiagonal()));
  }
  // Flattened to a plane, the two directions left still give the rotation.
  EXPECT_LT((compute_nearest_rotation(R * Eigen::Vector3d(1, 1, 0).asDiagonal()) - R).norm(), 1e-12);
}

TEST(NearestRotation, DoesNotDependOnScale) {
  Jitter jitter(3);
  const Eigen::Matrix3d F = random_matrix(jitter);
  EXPECT_LT((compute_nearest_rotation(1e150 * F) - compute_nearest_rotation(F)).norm(), 1e-13);
  EXPECT_LT((compute_nearest_rotation(1e-150 * F) - compute_nearest_rotation(F)).norm(), 1e-13);
}

TEST(NearestRotation, IsTheIdentityWhereFIsNotFinite) {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(compute_nearest_rotation(F), Eigen::Matrix3d::Identity());
  F(1, 2) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(compute_nearest_rotation(F), Eigen::Matrix3d::Identity());
}

}  // namespace
}  // namespace lipofill::solid::testing
