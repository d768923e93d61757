// The mobilities that pressures are preconditioned with: what they are, when they are renewed, and
// that taking them up again gives the same bits.

#include "core/step/lagged_mobility.h"

#include <gtest/gtest.h>

#include <memory>

namespace lipofill::step {
namespace {

constexpr int kSide = 12;  ///< more cells than are solved directly
constexpr int kCells = kSide * kSide;
constexpr double kStep = 0.01;

/// A flat film of 2 mm cells on walls that move one another.
struct FlatFilm {
  film::FilmGrid grid = film::make_film_grid({0, 1, 0, 1}, kSide, kSide, std::vector<int>(kCells, 0));
  film::FilmMetric metric;
  film::FilmProjection projection{grid};
  film::Fat fat;
  Eigen::MatrixXd compliance;
  coupling::WallCompliance walls;
  coupling::FilmSolver solver{{&projection}};
  LaggedMobility mobility{solver, true};

  explicit FlatFilm(double softness = 1e-13) {
    Eigen::Matrix3Xd vertices(3, grid.n_vertices());
    for (int j = 0; j <= kSide; ++j) {
      for (int i = 0; i <= kSide; ++i) vertices.col(grid.vertex(i, j)) << 2e-3 * i, 2e-3 * j, 0.0;
    }
    metric = film::compute_film_metric(grid, vertices);
    set_softness(softness);
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(grid.n_edges());
    Eigen::VectorXd injected = Eigen::VectorXd::Zero(kCells);
    injected[30] = 1e-9;
    projection.begin_step(
        {&metric, fat, Eigen::VectorXd(1e-3 * metric.area), injected, still, still, kStep, {}, {}, 0.0});
  }

  void set_softness(double softness) {
    compliance.resize(kCells, kCells);
    for (int a = 0; a < kCells; ++a) {
      for (int b = 0; b < kCells; ++b) compliance(a, b) = softness * std::exp(-0.3 * std::abs(a - b));
    }
    walls.dense = &compliance;
    walls.diagonal = compliance.diagonal();
    solver.pressure_solver().set_walls(walls);
  }

  coupling::FilmSolution at_thickness(double thickness) const {
    coupling::FilmSolution at;
    at.pressure.setZero(kCells);
    at.volume = thickness * metric.area;
    at.flux = {Eigen::VectorXd::Zero(grid.n_edges())};
    return at;
  }
  mechanics::SimulationState state_of(double thickness) {
    mechanics::SimulationState state;
    state.films.resize(1);
    mobility.renew(at_thickness(thickness), state);
    return state;
  }
  /// Pressures of the step under way, to the bits that the preconditioner leaves.
  Eigen::VectorXd solve() {
    coupling::FilmSolution solution = at_thickness(1e-3);
    solver.solve(solution.volume, {}, {}, solution);
    EXPECT_TRUE(solution.converged);
    return solution.pressure;
  }
};

/// dt J of square cells: each side carries k = h^3 / (12 mu + rho h^2 / dt), the corners nothing.
TEST(LaggedMobility, NotesTheMobilityOfASolution) {
  FlatFilm film;
  constexpr double kThickness = 0.7e-3;
  const mechanics::SimulationState state = film.state_of(kThickness);
  const double k = kThickness * kThickness * kThickness /
                   (12.0 * film.fat.viscosity + film.fat.density * kThickness * kThickness / kStep);
  Eigen::SparseMatrix<double> J = film.projection.pattern();
  ASSERT_EQ(state.films[0].factored_mobility.size(), J.nonZeros());
  J.coeffs() = state.films[0].factored_mobility;
  const int inside = 5 * kSide + 5;
  EXPECT_NEAR(J.coeff(inside, inside), 4.0 * kStep * k, 1e-9 * kStep * k);
  EXPECT_NEAR(J.coeff(0, 0), 2.0 * kStep * k, 1e-9 * kStep * k);
  EXPECT_NEAR(J.coeff(inside, inside + 1), -kStep * k, 1e-9 * kStep * k);
  EXPECT_NEAR(J.coeff(inside, inside + kSide), -kStep * k, 1e-9 * kStep * k);
  EXPECT_NEAR(J.coeff(inside, inside + kSide + 1), 0.0, 1e-9 * kStep * k);
}

TEST(LaggedMobility, IsDueWhenLateIterationsHaveCostAsMuch) {
  FlatFilm film;
  mechanics::SimulationState state = film.state_of(1e-3);
  const int worth = 4 + kCells / 45;
  state.late_pressure_iterations = worth;
  EXPECT_FALSE(film.mobility.is_due(state));
  state.late_pressure_iterations = worth + 1;
  EXPECT_TRUE(film.mobility.is_due(state));
  film.mobility.renew(film.at_thickness(1e-3), state);
  EXPECT_EQ(state.late_pressure_iterations, 0);
}

/// Once forgotten it is made anew, with the walls that there are now.
TEST(LaggedMobility, ForgottenItTakesTheNewWalls) {
  FlatFilm film;
  const mechanics::SimulationState state = film.state_of(1e-3);
  film.set_softness(4e-13);
  film.mobility.forget();
  film.mobility.take_up(state);
  FlatFilm fresh(4e-13);
  fresh.mobility.take_up(state);
  EXPECT_EQ(film.solve(), fresh.solve());
}

TEST(LaggedMobility, UnusedItLeavesStateAndSolverAlone) {
  FlatFilm film;
  LaggedMobility unused(film.solver, false);
  mechanics::SimulationState state;
  state.films.resize(1);
  state.late_pressure_iterations = 1000;
  EXPECT_FALSE(unused.is_used());
  EXPECT_FALSE(unused.is_due(state));
  unused.take_up(state);
  unused.renew(film.at_thickness(1e-3), state);
  EXPECT_EQ(state.films[0].factored_mobility.size(), 0);
  EXPECT_EQ(state.late_pressure_iterations, 1000);
}

}  // namespace
}  // namespace lipofill::step
