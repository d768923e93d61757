#include "core/coupling/film_solve.h"

#include <gtest/gtest.h>

#include "core/film/film_metric.h"

namespace lipofill::coupling {
namespace {

/// A flat film of n x n cells of 2 mm.
struct FlatFilm {
  film::FilmGrid grid;
  film::FilmMetric metric;
  film::FilmProjection projection;
  film::Fat fat;

  explicit FlatFilm(int n)
      : grid(film::make_film_grid({0, 1, 0, 1}, n, n, std::vector<int>(n * n, 0))), projection(grid) {
    Eigen::Matrix3Xd vertices(3, grid.n_vertices());
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) vertices.col(grid.vertex(i, j)) << 2e-3 * i, 2e-3 * j, 0.0;
    }
    metric = film::compute_film_metric(grid, vertices);
  }

  FilmSolution begin(double thickness, int source, double injected, double dt) {
    const Eigen::VectorXd volume = thickness * metric.area;
    Eigen::VectorXd into = Eigen::VectorXd::Zero(grid.n_cells());
    into[source] = injected;
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(grid.n_edges());
    projection.begin_step({&metric, fat, volume, into, still, still, dt, {}, {}, 0.0});
    return {Eigen::VectorXd::Zero(grid.n_cells()), volume, {}, {still}, 0, false, 0.0};
  }
};

FilmSolution solve(FlatFilm& film, const WallCompliance& walls, const FilmSolution& start) {
  FilmSolver solver({&film.projection});
  solver.pressure_solver().set_walls(walls);
  FilmSolution solution = start;
  solver.solve(start.volume, {}, {}, solution);
  return solution;
}

TEST(FilmSolve, KeepsVolumeAndPositivityAtAnyStep) {
  for (const double dt : {1e-3, 1e-2, 1.0, 10.0}) {
    FlatFilm film(9);
    const double injected = 2e-7;
    const FilmSolution start = film.begin(0.05e-3, 40, injected, dt);
    WallCompliance walls;
    walls.diagonal = film.metric.area / 1e6;
    const FilmSolution result = solve(film, walls, start);
    EXPECT_TRUE(result.converged) << "dt " << dt << " change " << result.change;
    EXPECT_GT(result.volume.minCoeff(), 0.0);
    EXPECT_NEAR(result.volume.sum(), start.volume.sum() + injected, 1e-14 * result.volume.sum());
  }
}

TEST(FilmSolve, FullComplianceSatisfiesTheCoupledEquation) {
  // (dt J + C) p = V* - g0 with V' = V* - dt J p, so that the gap at the pressure, g0 + C p, is V'.
  FlatFilm film(5);
  Eigen::MatrixXd c = Eigen::MatrixXd::Random(25, 25);
  c = 1e-12 * (c * c.transpose() + 25.0 * Eigen::MatrixXd::Identity(25, 25));
  const FilmSolution start = film.begin(0.2e-3, 12, 1e-8, 0.01);
  WallCompliance walls;
  walls.dense = &c;
  const FilmSolution result = solve(film, walls, start);
  ASSERT_TRUE(result.converged);
  EXPECT_LT((start.volume + c * result.pressure - result.volume).cwiseAbs().maxCoeff(),
            1e-12 * result.volume.maxCoeff());
}

TEST(FilmSolve, TakingMoreThanThereIsDoesNotConverge) {
  FlatFilm film(5);
  const FilmSolution start = film.begin(0.05e-3, 12, -1e-7, 0.01);
  WallCompliance walls;
  walls.diagonal = film.metric.area / 1e6;
  EXPECT_FALSE(solve(film, walls, start).converged);
}

}  // namespace
}  // namespace lipofill::coupling
