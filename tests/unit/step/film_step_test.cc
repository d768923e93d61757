// The films' side of a step on walls whose answer is known: Winkler's, where p = k (V - V_rest)/a.

#include "core/step/film_step.h"

#include <gtest/gtest.h>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::step {
namespace {

/// One film between Winkler walls, without tissue.
struct WinklerCase {
  std::shared_ptr<const model::FaceModel> model = simulation::make_small_model();
  plan::SimulationSpec spec = simulation::make_small_plan();
  std::vector<plan::FilmLayout> films{[this] {
    plan::FilmLayout film = *plan::place_film(*model, spec.films[0]);
    film.wall = plan::FilmWallKind::kWinkler;
    film.wall_stiffness = 2e6;
    return film;
  }()};
  mechanics::FilmCells cells = mechanics::number_cells(films);
  mechanics::StepCost cost;
  mechanics::FilmGeometry geometry{model->geometry.grid, films, cells, nullptr};
  FilmStep step{films, cells, geometry, spec, nullptr, cost};
};

TEST(FilmStep, WinklerWallsHoldTheFatAndItsPressure) {
  WinklerCase c;
  mechanics::SimulationState from;
  c.step.set_rest(from);
  const double at_rest = from.films[0].volume.sum();
  std::vector<Eigen::VectorXd> injected{Eigen::VectorXd::Zero(c.cells.n())};
  injected[0][c.cells.n() / 2] = 1e-8;
  mechanics::SimulationState next = from;
  c.step.begin(injected, 0.01, next);
  coupling::FilmSolution solution;
  solution.pressure.setZero(c.cells.n());
  solution.volume = from.films[0].volume;
  c.step.set_start_flux(from, solution);
  c.step.update_walls();
  ASSERT_TRUE(c.step.solve(c.step.walls().rest_volume(), next, solution));
  c.step.finish(from, 0.01, solution, next);
  EXPECT_NEAR(next.films[0].volume.sum(), at_rest + 1e-8, 1e-12 * at_rest);
  Eigen::VectorXd gap;
  c.step.walls().compute_gap_of_own_walls(next.films[0].pressure, gap);
  EXPECT_LT((gap - next.films[0].volume).norm(), 1e-8 * at_rest);
  EXPECT_LT(c.step.walls().relative_gap_error(gap, solution), 1e-8);
  const Eigen::VectorXd spring =
      2e6 * (next.films[0].volume - c.step.walls().rest_volume()).cwiseQuotient(c.geometry.rest_area(0));
  EXPECT_LT((next.films[0].pressure - spring).norm(), 1e-6 * spring.norm());
}

TEST(FilmStep, TheCannulaEntersTheTissueWhereItDelivers) {
  WinklerCase c;
  c.films[0].connective_tissue.entry_pressure = 1e9;
  mechanics::SimulationState state;
  c.step.set_rest(state);
  ASSERT_EQ(state.films[0].is_entered.size(), c.cells.n());
  std::vector<Eigen::VectorXd> injected{Eigen::VectorXd::Zero(c.cells.n())};
  injected[0][3] = 1e-9;
  c.step.begin(injected, 0.01, state);
  EXPECT_EQ(state.films[0].is_entered.sum(), 1.0);
  EXPECT_EQ(state.films[0].is_entered[3], 1.0);
}

TEST(FilmStep, WhatTheFatDoesNotFillBelowTheSuctionLimitIsVoid) {
  WinklerCase c;
  c.spec.suction_limit = 500.0;
  FilmStep step(c.films, c.cells, c.geometry, c.spec, nullptr, c.cost);
  mechanics::SimulationState state;
  step.set_rest(state);
  state.films[0].pressure[2] = -500.0;
  Eigen::VectorXd gap = state.films[0].volume;
  gap[2] += 3e-9;
  gap[4] += 3e-9;  // a mismatch above the limit is no void
  const Eigen::VectorXd empty = step.compute_void(state, gap);
  EXPECT_NEAR(empty[2], 3e-9, 1e-20);
  EXPECT_EQ(empty.sum(), empty[2]);
}

}  // namespace
}  // namespace lipofill::step
