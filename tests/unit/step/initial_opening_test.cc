// Films that begin with a thickness of their own, under walls that stretch while they open.

#include "core/step/initial_opening.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/step/coupled_step.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::step {
namespace {

constexpr double kRest = 0.1e-3;
constexpr double kBump = 9e-3;

/// The small model, its film a bump of fat in the middle at the start.
struct BumpCase {
  std::shared_ptr<const model::FaceModel> model = simulation::make_small_model();
  plan::SimulationSpec spec = simulation::make_small_plan();
  std::vector<plan::FilmLayout> films;
  std::unique_ptr<CoupledStep> step;

  explicit BumpCase(double bump) {
    spec.films[0].rest_thickness = geometry::ScalarField::constant(kRest);
    geometry::ScalarField start{7, 7, std::vector<double>(49, kRest)};
    for (int j = 2; j < 5; ++j) {
      for (int i = 2; i < 5; ++i) start.values[7 * j + i] = kRest + bump * (i == 3 && j == 3 ? 1.0 : 0.5);
    }
    if (bump > 0.0) spec.films[0].initial_thickness = start;
    films = {*plan::place_film(*model, spec.films[0])};
    auto created = CoupledStep::create(*model, films, spec);
    EXPECT_TRUE(created.ok()) << created.status();
    if (created.ok()) step = *std::move(created);
  }
};

TEST(InitialOpening, EveryCellHasTheThicknessAskedForWhereWallsStretch) {
  BumpCase c(kBump);
  ASSERT_TRUE(c.step);
  mechanics::SimulationState state = c.step->rest_state();
  const absl::Status opened = c.step->open_to_initial_thickness(state);
  ASSERT_TRUE(opened.ok()) << opened;
  const Eigen::VectorXd area = c.step->geometry().metric_at(0, state.positions).area;
  const Eigen::VectorXd& at_rest = c.step->geometry().rest_area(0);
  const Eigen::VectorXd& volume = state.films[0].volume;
  double stretch = 0.0;
  for (int cell = 0; cell < volume.size(); ++cell) {
    const geometry::ChartPoint centre = c.films[0].cell_centre(cell);
    const double asked_for = c.films[0].initial_thickness.at(centre.xi, centre.eta);
    EXPECT_NEAR(volume[cell] / area[cell] / asked_for, 1.0, kThicknessTolerance) << "cell " << cell;
    EXPECT_EQ(state.films[0].is_entered.size() == 0 || state.films[0].is_entered[cell] == (asked_for > kRest), true);
    stretch = std::max(stretch, std::abs(area[cell] / at_rest[cell] - 1.0));
  }
  EXPECT_GT(stretch, 0.02);  // the volume over areas at rest would be off by as much
  const StepOutcome outcome = c.step->describe(state);
  EXPECT_LT((outcome.gap - volume).cwiseAbs().sum(), 1e-7 * volume.sum());
}

TEST(InitialOpening, AFilmWithoutOneStaysAsItIsAtRest) {
  BumpCase c(0.0);
  ASSERT_TRUE(c.step);
  const mechanics::SimulationState rest = c.step->rest_state();
  mechanics::SimulationState state = rest;
  ASSERT_TRUE(c.step->open_to_initial_thickness(state).ok());
  EXPECT_EQ(state.positions, rest.positions);
  EXPECT_EQ(state.films[0].volume, rest.films[0].volume);
  EXPECT_EQ(state.films[0].pressure, rest.films[0].pressure);
}

}  // namespace
}  // namespace lipofill::step
