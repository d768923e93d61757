#include "core/solid/material.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

namespace lipofill::solid {
namespace {

using ::testing::HasSubstr;

TEST(ElasticityMatrix, InverseIsHookesLaw) {
  const double E = 2e5;
  const double nu = 0.45;
  const Eigen::Matrix<double, 6, 6> compliance = compute_elasticity_matrix({E, nu, 1000.0}).inverse();
  Eigen::Matrix<double, 6, 6> expected = Eigen::Matrix<double, 6, 6>::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) expected(i, j) = (i == j ? 1.0 : -nu) / E;
    expected(3 + i, 3 + i) = 2.0 * (1.0 + nu) / E;
  }
  EXPECT_LT((compliance - expected).cwiseAbs().maxCoeff(), 1e-13 / E * 10.0);
}

TEST(ElasticityMatrix, PressureOfAVolumeChangeIsTheBulkModulus) {
  const auto D = compute_elasticity_matrix({3e4, 0.49, 1000.0});
  const Eigen::Matrix<double, 6, 1> strain{1e-3, 1e-3, 1e-3, 0, 0, 0};
  const double bulk_modulus = 3e4 / (3.0 * (1.0 - 2.0 * 0.49));
  EXPECT_NEAR((D * strain)[1], bulk_modulus * 3e-3, 1e-9 * bulk_modulus);
}

TEST(CheckMaterial, TakesTheBounds) {
  FieldViolations violations;
  check_material("m", {1.0, 0.0, 1.0}, violations);
  check_material("m", {1e9, 0.4999, 1e4}, violations);
  EXPECT_TRUE(violations.empty());
}

TEST(CheckMaterial, NamesFieldValueAndBound) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const ElasticMaterial& bad :
       {ElasticMaterial{0.0, 0.5, -1.0}, ElasticMaterial{nan, nan, nan}, ElasticMaterial{infinity, -0.1, infinity}}) {
    FieldViolations violations;
    check_material("materials[2]", bad, violations);
    ASSERT_EQ(violations.all().size(), 3u);
    EXPECT_EQ(violations.all()[0].field, "materials[2].youngs_modulus");
    EXPECT_EQ(violations.all()[1].field, "materials[2].poisson_ratio");
    EXPECT_THAT(violations.all()[1].description, HasSubstr("[0, 0.5)"));
    EXPECT_EQ(violations.all()[2].field, "materials[2].density");
  }
}

}  // namespace
}  // namespace lipofill::solid
