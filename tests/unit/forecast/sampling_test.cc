// Points and terms from OpenTURNS: even, the same in every draw, those that a figure is made of.

#include "core/forecast/sampling.h"

#include <gmock/gmock.h>

#include <thread>

#include "core/forecast/influence.h"

namespace lipofill::forecast {
namespace {

TEST(Sampling, PointsFillTheCubeEvenly) {
  const Eigen::MatrixXd points = draw_points(1023, 12);
  EXPECT_GT(points.minCoeff(), 0.0);
  EXPECT_LT(points.maxCoeff(), 1.0);
  for (int k = 0; k < 12; ++k) {
    EXPECT_NEAR(points.col(k).mean(), 0.5, 1e-3);
    EXPECT_EQ((points.col(k).array() < 0.25).count(), 255) << "with the point 0 that is left out a quarter of 1024";
  }
}

TEST(Sampling, TheFirstOfMoreAreThoseOfFewer) {
  const Eigen::MatrixXd more = draw_points(500, 7);
  EXPECT_EQ(draw_points(100, 7), more.topRows(100));
}

TEST(Sampling, TermsAreThoseThatAFigureIsMadeOf) {
  const Eigen::MatrixXd points = 2.0 * draw_points(200, 3).array() - 1.0;
  Eigen::VectorXd figure(points.rows());
  for (Eigen::Index k = 0; k < points.rows(); ++k) {
    figure[k] = 2.0 * orthonormal_polynomial(false, 2, points(k, 0)) + points(k, 1) * points(k, 2);
  }
  EXPECT_THAT(select_terms(points, {false, false, false}, figure, 4),
              ::testing::IsSupersetOf({Term{2, 0, 0}, Term{0, 1, 1}}));
}

TEST(Sampling, ThreadsTakeTurns) {
  const Eigen::MatrixXd alone = draw_points(300, 5);
  std::vector<Eigen::MatrixXd> drawn(4);
  std::vector<std::thread> threads;
  for (Eigen::MatrixXd& points : drawn) threads.emplace_back([&points] { points = draw_points(300, 5); });
  for (std::thread& thread : threads) thread.join();
  for (const Eigen::MatrixXd& points : drawn) EXPECT_EQ(points, alone);
}

}  // namespace
}  // namespace lipofill::forecast
