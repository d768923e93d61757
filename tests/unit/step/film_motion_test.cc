// Viscosity and advection of one film, one after the other, on flows that have closed forms.

#include "core/step/film_motion.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lipofill::step {
namespace {

constexpr int kCells = 8;
constexpr double kWidth = 5e-3;  ///< of a cell [m]

/// A flat film of 8 x 8 cells.
struct FlatFilm {
  film::FilmGrid grid = film::make_film_grid({0, 1, 0, 1}, kCells, kCells, std::vector<int>(kCells* kCells, 0));
  film::FilmMetric metric;
  mechanics::FilmState state;

  FlatFilm() {
    Eigen::Matrix3Xd vertices(3, grid.n_vertices());
    for (int j = 0; j <= kCells; ++j) {
      for (int i = 0; i <= kCells; ++i) vertices.col(grid.vertex(i, j)) << kWidth * i, kWidth * j, 0.0;
    }
    metric = film::compute_film_metric(grid, vertices);
    state.velocity.setZero(grid.n_edges());
    set_thickness(1e-3);
  }

  void set_thickness(double h) { state.volume = h * metric.area; }
  int column(int edge) const { return grid.slot_i(grid.slot_of_cell[grid.edges[edge].right]); }
  int row(int edge) const { return grid.slot_j(grid.slot_of_cell[grid.edges[edge].right]); }
  bool crosses_xi(int edge) const { return grid.edges[edge].direction == 0; }
  /// True for edges at least two cells away from every wall.
  bool is_inside(int edge) const {
    return std::min(column(edge), row(edge)) >= 2 && std::max(column(edge), row(edge)) <= kCells - 3;
  }
};

/// Between walls close to each other a flow loses its momentum to them alone: U' = U / (1 + 12 mu
/// dt / (rho h^2)).
TEST(FilmMotion, FrictionSlowsByTheThicknessOfTheVolume) {
  FlatFilm film;
  FilmMotion motion(film.grid);
  const film::Fat fat{15.0, 920.0, film::WallFriction::kNoSlip};
  constexpr double kStep = 1e-5;
  for (int e = 0; e < film.grid.n_edges(); ++e) film.state.velocity[e] = film.crosses_xi(e) ? 1e-6 : 0.0;
  for (const double h : {0.5e-3, 1e-3}) {
    film.set_thickness(h);
    Eigen::VectorXd velocity;
    motion.advance(film.metric, fat, film.state, kStep, velocity);
    const double expected = 1e-6 / (1.0 + 12.0 * 15.0 * kStep / (920.0 * h * h));
    for (int e = 0; e < film.grid.n_edges(); ++e) {
      if (film.is_inside(e) && film.crosses_xi(e)) EXPECT_NEAR(velocity[e], expected, 1e-3 * expected) << h;
    }
  }
}

/// Without friction and viscosity a shear flow v(x) = c x is carried along by a uniform u:
/// v'(x) = c (x - u dt).
TEST(FilmMotion, TheFlowCarriesItsVelocityAlong) {
  FlatFilm film;
  FilmMotion motion(film.grid);
  const film::Fat fat{1e-12, 920.0, film::WallFriction::kNone};
  constexpr double kSpeed = 0.1, kShear = 0.5, kStep = 0.02;
  const auto x_of = [&](int e) { return kWidth * (film.column(e) + 0.5); };
  for (int e = 0; e < film.grid.n_edges(); ++e) {
    film.state.velocity[e] = kWidth * (film.crosses_xi(e) ? kSpeed : kShear * x_of(e));
  }
  Eigen::VectorXd velocity;
  motion.advance(film.metric, fat, film.state, kStep, velocity);
  int compared = 0;
  for (int e = 0; e < film.grid.n_edges(); ++e) {
    if (!film.is_inside(e) || film.row(e) < 4 || film.crosses_xi(e)) continue;
    EXPECT_NEAR(velocity[e] / kWidth, kShear * (x_of(e) - kSpeed * kStep), 1e-2 * kShear * kSpeed * kStep);
    ++compared;
  }
  EXPECT_GT(compared, 4);
}

/// Cells without fat, and cells that owe some, are dry: nothing flows out of them.
TEST(FilmMotion, NothingFlowsOutOfDryCells) {
  FlatFilm film;
  FilmMotion motion(film.grid);
  const int edge = 20;
  const int upstream = film.grid.edges[edge].left;
  film.state.velocity.setConstant(1e-9);
  Eigen::VectorXd wet, dry;
  const film::Fat fat{15.0, 920.0, film::WallFriction::kNone};
  motion.advance(film.metric, fat, film.state, 1e-9, wet);
  EXPECT_NEAR(wet[edge], 1e-9, 1e-12);
  film.state.volume[upstream] = -1e-9;
  motion.advance(film.metric, fat, film.state, 1e-9, dry);
  EXPECT_LT(std::abs(dry[edge]), 1e-13);
  EXPECT_NEAR(dry[edge + 30], 1e-9, 1e-12);
}

}  // namespace
}  // namespace lipofill::step
