// Anderson's acceleration: it finds the fixed point of a linear map in as many steps as the map has
// directions, and of one that the plain iteration runs away from.

#include "core/equilibrium/anderson.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace lipofill::equilibrium {
namespace {

/// y <- M y + b with as many different rates as M has rows.
struct LinearMap {
  Eigen::MatrixXd m;
  Eigen::VectorXd b;
  explicit LinearMap(const Eigen::VectorXd& rates) {
    const Eigen::Index n = rates.size();
    Eigen::MatrixXd directions(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = 0; i < n; ++i) directions(i, j) = 1.0 / (1.0 + static_cast<double>(i + 2 * j)) + (i == j);
    }
    m = directions * rates.asDiagonal() * directions.inverse();
    b = Eigen::VectorXd::LinSpaced(n, 1.0, 2.0);
  }
  Eigen::VectorXd correction(const Eigen::VectorXd& y) const { return m * y + b - y; }
  Eigen::VectorXd fixed_point() const { return (Eigen::MatrixXd::Identity(m.rows(), m.cols()) - m).lu().solve(b); }
};

double error_after(const LinearMap& map, int steps, Eigen::Index n_measured) {
  AndersonMixing mixing;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(map.b.size()), next;
  for (int k = 0; k < steps; ++k) {
    mixing.mix(y, map.correction(y), n_measured, next);
    y = next;
  }
  return (y - map.fixed_point()).norm() / map.fixed_point().norm();
}

TEST(AndersonMixing, EndsAfterOneStepMoreThanThereAreDirections) {
  const LinearMap map(Eigen::Vector4d(0.9, 0.7, 0.4, -0.5));
  EXPECT_GT(error_after(map, 3, 4), 1e-4);
  EXPECT_LT(error_after(map, 6, 4), 1e-9);
}

/// The plain iteration multiplies an error by 3.
TEST(AndersonMixing, FindsAFixedPointThatRepels) {
  const LinearMap map(Eigen::Vector3d(3.0, -2.0, 0.5));
  EXPECT_LT(error_after(map, 5, 3), 1e-9);
}

/// What is not measured is mixed alike: a pressure that follows the displacement.
TEST(AndersonMixing, CarriesWhatItDoesNotMeasure) {
  const LinearMap map(Eigen::Vector4d(0.9, 0.7, 0.0, 0.0));
  EXPECT_LT(error_after(map, 6, 3), 1e-8);
}

/// Another fixed point of the same map is found from what is known of the map, in two steps.
TEST(AndersonMixing, KeepsWhatItKnowsOverALeap) {
  LinearMap map(Eigen::Vector3d(0.9, 0.7, 0.4));
  AndersonMixing mixing;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(3), next;
  const auto step = [&] {
    mixing.mix(y, map.correction(y), 3, next);
    y = next;
  };
  for (int k = 0; k < 5; ++k) step();
  map.b *= 1.5;
  mixing.leap();
  step();
  EXPECT_LT((y - map.fixed_point()).norm(), 1e-7 * y.norm());
}

TEST(AndersonMixing, ForgetsWhenToldTo) {
  const LinearMap map(Eigen::Vector3d(0.9, 0.7, 0.4));
  AndersonMixing fresh, used;
  Eigen::VectorXd y = Eigen::Vector3d(1.0, 2.0, 3.0), next, expected;
  for (int k = 0; k < 3; ++k) {
    used.mix(y, map.correction(y), 3, next);
    y = next;
  }
  used.reset();
  used.mix(y, map.correction(y), 3, next);
  fresh.mix(y, map.correction(y), 3, expected);
  EXPECT_EQ(next, expected);
  EXPECT_EQ(next, y + map.correction(y));
}

}  // namespace
}  // namespace lipofill::equilibrium
