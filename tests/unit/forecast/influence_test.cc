// Influences on figures whose Sobol indices can be told by hand.

#include "core/forecast/influence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/forecast/distribution.h"

namespace lipofill::forecast {
namespace {

Eigen::MatrixXd gaussian_points(int n, int inputs) {
  Eigen::MatrixXd points = draw_points(n, inputs);
  for (double& value : points.reshaped()) value = normal_quantile(value);
  return points;
}

TEST(Influence, PolynomialsAreOrthonormal) {
  constexpr int kPoints = 20000;
  for (const bool gaussian : {true, false}) {
    for (int a = 0; a <= 4; ++a) {
      for (int b = 0; b <= a; ++b) {
        double sum = 0.0;
        for (int k = 0; k < kPoints; ++k) {
          const double share = (k + 0.5) / kPoints;
          const double x = gaussian ? normal_quantile(share) : 2.0 * share - 1.0;
          sum += orthonormal_polynomial(gaussian, a, x) * orthonormal_polynomial(gaussian, b, x) / kPoints;
        }
        EXPECT_NEAR(sum, a == b ? 1.0 : 0.0, gaussian ? 0.06 : 1e-4) << gaussian << a << b;
      }
    }
  }
}

/// y = sum of c_k x_k: S_k = T_k = c_k^2 / sum of c^2, exactly.
TEST(Influence, OfALinearFigureIsExact) {
  const Eigen::MatrixXd x = gaussian_points(200, 4);
  const Eigen::Vector4d c(3.0, -2.0, 1.0, 0.0);
  const Influences found = find_influences(x, {true, true, true, true}, (x * c).array() + 5.0);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(found.of_input[k].first_order, c[k] * c[k] / 14.0, 1e-9);
    EXPECT_NEAR(found.of_input[k].total, c[k] * c[k] / 14.0, 1e-9);
    EXPECT_LT(found.of_input[k].total_error, 1e-6);
  }
  EXPECT_LT(found.unexplained, 1e-12);
}

/// y = x1 x2 of normal inputs is all interaction: S = 0, T = 1.
TEST(Influence, OfAProductIsAllInTheTotal) {
  const Eigen::MatrixXd x = gaussian_points(300, 3);
  const Influences found = find_influences(x, {true, true, true}, x.col(0).cwiseProduct(x.col(1)));
  EXPECT_NEAR(found.of_input[0].first_order, 0.0, 1e-9);
  EXPECT_NEAR(found.of_input[0].total, 1.0, 1e-9);
  EXPECT_NEAR(found.of_input[2].total, 0.0, 1e-9);
}

/// A part of the variance is noise that no input tells of.
TEST(Influence, SaysWhatItDoesNotExplain) {
  const Eigen::MatrixXd x = gaussian_points(400, 5);
  const Eigen::VectorXd y = x.col(0) + 0.7 * x.col(1) + x.col(3);
  const Influences found = find_influences(x.leftCols(3), {true, true, true}, y);
  EXPECT_NEAR(found.unexplained, 1.0 / 2.49, 0.1);
  EXPECT_NEAR(found.of_input[0].first_order, 1.0 / 1.49, 3.0 * found.of_input[0].first_order_error);
  EXPECT_GT(found.of_input[0].first_order_error, 0.0);
}

TEST(Influence, AFigureThatDoesNotVaryHasNone) {
  const Influences found = find_influences(gaussian_points(100, 2), {true, true}, Eigen::VectorXd::Constant(100, 7.0));
  EXPECT_EQ(found.of_input[0].total, 0.0);
  EXPECT_EQ(found.unexplained, 0.0);
}

}  // namespace
}  // namespace lipofill::forecast
