// Values over the nodes of a skin where some were not measured.

#include "core/geometry/gap_filling.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "core/geometry/node_values.h"

namespace lipofill::geometry {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kReach = 6e-3;

/// A flat skin of n x n cells, `side` wide [m].
LayeredGrid make_flat_skin(int n, double side) {
  LayeredGrid grid;
  grid.n_xi = grid.n_eta = n;
  grid.nodes = Eigen::Matrix3Xd::Zero(3, grid.nodes_per_level());
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) grid.nodes.col(grid.surface_index(i, j)) << side * i / n, side * j / n, 0.0;
  }
  return grid;
}

/// 12 mm where x < 20 mm, unknown beyond; 3 mm in general. The difference fades as
/// cosh((X - x) / L) / cosh((X - x0) / L) up to the free border at X.
double largest_error(int n) {
  const LayeredGrid grid = make_flat_skin(n, 0.060);
  const int known = n / 3;
  Eigen::VectorXd values = Eigen::VectorXd::Constant(grid.nodes_per_level(), 12e-3);
  for (int j = 0; j <= n; ++j) {
    for (int i = known + 1; i <= n; ++i) values[grid.surface_index(i, j)] = kUnknown;
  }
  fill_towards(grid, Eigen::VectorXd::Constant(values.size(), 3e-3), kReach, values);
  double error = 0.0;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = 0.060 * std::max(i, known) / n;
      const double exact = 3e-3 + 9e-3 * std::cosh((0.060 - x) / kReach) / std::cosh(0.040 / kReach);
      error = std::max(error, std::abs(values[grid.surface_index(i, j)] - exact));
    }
  }
  return error;
}

TEST(GapFilling, DifferencesFadeWithTheDistanceFromWhatIsKnown) {
  const double coarse = largest_error(30), fine = largest_error(60);
  printf("error at 30 and 60 cells: %.4f and %.4f mm\n", coarse * 1e3, fine * 1e3);
  EXPECT_LT(coarse, 0.05e-3);
  EXPECT_GT(coarse / fine, 3.0) << "second order";
}

TEST(GapFilling, WhatIsKnownStaysAndNothingKnownIsTheGeneralFigure) {
  const LayeredGrid grid = make_flat_skin(8, 0.02);
  const Eigen::VectorXd general = Eigen::VectorXd::LinSpaced(grid.nodes_per_level(), 1.0, 2.0);
  Eigen::VectorXd values = Eigen::VectorXd::Constant(grid.nodes_per_level(), kUnknown);
  fill_towards(grid, general, kReach, values);
  EXPECT_LT((values - general).cwiseAbs().maxCoeff(), 1e-15);
  values.setConstant(kUnknown);
  values[5] = 7.0;
  fill_towards(grid, general, kReach, values);
  EXPECT_EQ(values[5], 7.0);
  EXPECT_GT(values[4], general[4]);
  EXPECT_LT(values[4], 7.0);
}

TEST(GapFilling, HarmonicContinuationStaysBetweenWhatIsAroundIt) {
  const LayeredGrid grid = make_flat_skin(8, 0.02);
  Eigen::VectorXd values = Eigen::VectorXd::Constant(grid.nodes_per_level(), kUnknown);
  fill_harmonically(grid, values);
  EXPECT_TRUE(values.array().isNaN().all()) << "nothing to continue";
  values[0] = 1.0;
  values[grid.nodes_per_level() - 1] = 3.0;
  fill_harmonically(grid, values);
  EXPECT_NEAR(values[grid.surface_index(4, 4)], 2.0, 1e-12);
  EXPECT_EQ(values.minCoeff(), 1.0);
  EXPECT_EQ(values.maxCoeff(), 3.0);
}

TEST(GapFilling, ANodeIsUnknownWhereASampleBesideItIs) {
  const LayeredGrid grid = make_flat_skin(4, 0.02);
  const ScalarField field{3, 1, {1.0, 2.0, kUnknown}};
  EXPECT_TRUE(has_gaps(field));
  EXPECT_FALSE(has_gaps(without_gaps(field)));
  EXPECT_EQ(without_gaps(field).values[2], 1.5);
  const Eigen::VectorXd values = sample_with_gaps(field, grid);
  EXPECT_EQ(values[0], 1.0);
  EXPECT_EQ(values[1], 1.5);
  EXPECT_EQ(values[2], 2.0) << "the node on the last sample that is known";
  EXPECT_TRUE(std::isnan(values[3]));
  EXPECT_TRUE(std::isnan(values[4]));
}

}  // namespace
}  // namespace lipofill::geometry
