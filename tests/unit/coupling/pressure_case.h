#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/coupling/wall_compliance.h"
#include "core/film/film_metric.h"
#include "core/film/film_projection.h"

namespace lipofill::coupling {

/// A film of 2 mm cells, wet in its middle and dry elsewhere, on walls like tissue: each cell moves
/// its neighbours.
struct PressureCase {
  int side;
  int n = side * side;
  film::FilmGrid grid = film::make_film_grid({0, 1, 0, 1}, side, side, std::vector<int>(n, 0));
  film::FilmMetric metric;
  film::FilmProjection projection{grid};
  Eigen::MatrixXd c;
  WallCompliance walls;

  explicit PressureCase(int cells_a_side, double compliance = 1e-12) : side(cells_a_side) {
    Eigen::Matrix3Xd vertices(3, grid.n_vertices());
    for (int j = 0; j <= side; ++j) {
      for (int i = 0; i <= side; ++i) vertices.col(grid.vertex(i, j)) << 2e-3 * i, 2e-3 * j, 0.0;
    }
    metric = film::compute_film_metric(grid, vertices);
    c.resize(n, n);
    for (int a = 0; a < n; ++a) {
      for (int b = 0; b < n; ++b) {
        const double distance = std::hypot(a % side - b % side, a / side - b / side);
        c(a, b) = compliance * std::exp(-0.5 * distance);
      }
    }
    walls.dense = &c;
  }

  /// dt J of a blister of this height.
  Eigen::VectorXd take_thickness(double height, double dt) {
    Eigen::VectorXd volume(n);
    for (int cell = 0; cell < n; ++cell) {
      const double r = std::hypot(cell % side - side / 2, cell / side - side / 2);
      volume[cell] = metric.area[cell] * height * std::max(0.0, 1.0 - 0.04 * r * r);
    }
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(grid.n_edges());
    film::FilmStepInput input;
    input.metric = &metric;
    input.fat = {};
    input.volume = volume;
    input.injected = Eigen::VectorXd::Zero(n);
    input.velocity = still;
    input.body_force = still;
    input.dt = dt;
    projection.begin_step(std::move(input));
    projection.set_thickness(volume, still);
    return projection.linearise(Eigen::VectorXd::Zero(n)).coeffs();
  }

  std::vector<char> hold_none() const { return std::vector<char>(n, 0); }
  std::vector<char> hold_every_fifth() const {
    std::vector<char> held = hold_none();
    for (int cell = 0; cell < n; cell += 5) held[cell] = 1;
    return held;
  }

  Eigen::VectorXd solve_densely(const std::vector<char>& held, const Eigen::VectorXd& r) {
    Eigen::MatrixXd system = c + Eigen::MatrixXd(projection.linearise(Eigen::VectorXd::Zero(n)));
    Eigen::VectorXd right = r;
    for (int i = 0; i < n; ++i) {
      if (!held[i]) continue;
      system.row(i).setZero();
      system.col(i).setZero();
      system(i, i) = 1.0;
      right[i] = 0.0;
    }
    return system.ldlt().solve(right);
  }

  void expect_solution(const std::vector<char>& held, const Eigen::VectorXd& r, const Eigen::VectorXd& dp,
                       const Eigen::VectorXd& moved, double bound) {
    const Eigen::VectorXd exact = solve_densely(held, r);
    EXPECT_LT((dp - exact).norm(), bound * exact.norm());
    EXPECT_LT((moved - c * dp).norm(), 1e-6 * (c * dp).norm());
    for (int i = 0; i < n; ++i) {
      if (!held[i]) continue;
      EXPECT_EQ(dp[i], 0.0);
    }
  }
};

}  // namespace lipofill::coupling
