// Where a drag goes: exact on lines and parabolas, and along the directions that were learned.

#include "core/equilibrium/trend.h"

#include <gtest/gtest.h>

namespace lipofill::equilibrium {
namespace {

/// Unknowns that depend on the first of two volumes by a parabola, on the second by a line.
Eigen::VectorXd unknowns_at(const Eigen::Vector2d& v) {
  return Eigen::Vector3d(1.0 + 2.0 * v[0] - 0.5 * v[0] * v[0], 3.0 * v[0] * v[0] + v[1], 4.0 * v[1]);
}

/// A drag that comes by places, and what it predicts of the next one.
Eigen::VectorXd predict_after(const std::vector<Eigen::Vector2d>& places, const Eigen::Vector2d& next) {
  Trend trend;
  trend.begin(Eigen::MatrixXd::Zero(3, 2));
  for (size_t k = 1; k < places.size(); ++k) {
    trend.learn(places[k] - places[k - 1], unknowns_at(places[k]) - unknowns_at(places[k - 1]));
  }
  return unknowns_at(places.back()) + trend.predict(next - places.back());
}

TEST(Trend, TakesTheParabolaAlongALine) {
  for (const double next : {0.7, 0.25, -1.0}) {
    SCOPED_TRACE(next);
    const Eigen::VectorXd predicted = predict_after({{0.0, 1.0}, {0.2, 1.0}, {0.5, 1.0}}, {next, 1.0});
    EXPECT_LT((predicted - unknowns_at({next, 1.0})).norm(), 1e-13);
  }
}

/// There, and back along the way that it came.
TEST(Trend, ComesBackToWhereItWas) {
  const Eigen::VectorXd predicted = predict_after({{0.0, 1.0}, {0.2, 1.0}, {0.5, 1.0}}, {0.2, 1.0});
  EXPECT_LT((predicted - unknowns_at({0.2, 1.0})).norm(), 1e-13);
}

/// To and fro tells nothing of a bend: the line is left.
TEST(Trend, TakesTheLineWhereNoParabolaIsKnown) {
  const Eigen::VectorXd predicted = predict_after({{0.2, 1.0}, {0.4, 1.0}, {0.2, 1.0}}, {0.3, 1.0});
  EXPECT_TRUE(predicted.allFinite());
  EXPECT_LT((predicted - unknowns_at({0.3, 1.0})).norm(), 0.1);
}

/// The second volume was not moved last, but is known.
TEST(Trend, KeepsWhatItLearnedOfOtherDirections) {
  const Eigen::VectorXd predicted = predict_after({{0.0, 0.0}, {0.0, 1.0}, {0.1, 1.0}}, {0.1, 1.5});
  EXPECT_LT((predicted - unknowns_at({0.1, 1.5})).norm(), 1e-13);
}

TEST(Trend, LearnsNothingFromStandingStill) {
  Trend trend;
  trend.begin(Eigen::MatrixXd::Constant(3, 2, 7.0));
  trend.learn(Eigen::Vector2d::Zero(), Eigen::Vector3d::Zero());
  EXPECT_EQ(trend.predict(Eigen::Vector2d(1.0, 0.0)), Eigen::Vector3d::Constant(7.0));
}

}  // namespace
}  // namespace lipofill::equilibrium
