#include "tests/verification/coupling/refined_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <tuple>

#include "core/geometry/face_geometry.h"
#include "core/simulation/skin_difference.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

constexpr double kToldShareOfSkin = 0.95;

int refine(int divisions, double refinement) {
  return 2 * static_cast<int>(std::lround(0.5 * divisions * refinement));
}

/// Errors against the last of the results, without it.
std::vector<double> errors_against_last(const std::vector<RefinedResult>& results, double RefinedResult::*figure) {
  std::vector<double> errors;
  for (size_t k = 0; k + 1 < results.size(); ++k) errors.push_back(results[k].*figure / results.back().*figure - 1.0);
  return errors;
}

/// Differences of each result from the next finer one, as shares of the finest.
std::vector<double> changes(const std::vector<RefinedResult>& results, double RefinedResult::*figure) {
  std::vector<double> errors;
  for (size_t k = 0; k + 1 < results.size(); ++k)
    errors.push_back((results[k].*figure - results[k + 1].*figure) / results.back().*figure);
  return errors;
}

}  // namespace

RefinedResult settle_refined(const JawPlan& plan, const geometry::GridSize& ships, double refinement) {
  RefinedResult result;
  model::FaceModelSpec model_spec = plan.model;
  model_spec.n_xi = result.n_xi = refine(ships.n_xi, refinement);
  model_spec.n_eta = result.n_eta = refine(ships.n_eta, refinement);
  for (model::TissueLayerSpec& layer : model_spec.layers) layer.geometry.elements_through = 0;
  const auto model = model::build_face_model(model_spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  if (!model.ok()) return result;
  plan::SimulationSpec spec = plan.simulation;
  for (plan::FilmSpec& film : spec.films) film.n_xi = film.n_eta = 0;  // two hexahedra wide
  spec.goal = plan::TimeGoal::kSettledShape;
  auto simulation = simulation::Simulation::create(*model, spec);
  EXPECT_TRUE(simulation.ok()) << simulation.status();
  if (!simulation.ok()) return result;
  const std::clock_t began = std::clock();
  while ((*simulation)->phase() == simulation::Phase::kRunning) (*simulation)->advance_step();
  EXPECT_EQ((*simulation)->phase(), simulation::Phase::kSettled) << (*simulation)->reason();
  result.simulation = *std::move(simulation);
  result.lift = result.simulation->report().skin_max_displacement;
  result.pressure = result.simulation->zone_reports()[0].mean_pressure;
  std::printf("%d x %d, %d hexahedra, elements through", result.n_xi, result.n_eta, result.simulation->n_hexahedra());
  for (const int through : (*model)->geometry.grid.elements_through) std::printf(" %d", through);
  std::printf(": lift %.4f mm, pressure %.2f Pa, %.0f s\n", 1e3 * result.lift, result.pressure,
              static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC);
  std::fflush(stdout);
  return result;
}

double skin_difference(const RefinedResult& coarse, const RefinedResult& fine) {
  std::vector<double> squares = simulation::squared_skin_distances(
      coarse.simulation->frame({"skin"}), fine.simulation->frame_on(coarse.simulation->model().geometry));
  if (squares.empty()) return INFINITY;
  const auto at =
      squares.begin() + static_cast<std::ptrdiff_t>(kToldShareOfSkin * static_cast<double>(squares.size() - 1));
  std::nth_element(squares.begin(), at, squares.end());
  return std::sqrt(*at);
}

void record_refinement(const std::string& name, const JawPlan& plan, const geometry::GridSize& ships,
                       const std::vector<double>& refinements, const RefinementBounds& bounds) {
  std::vector<RefinedResult> results;
  for (const double refinement : refinements) {
    results.push_back(settle_refined(plan, ships, refinement));
    ASSERT_NE(results.back().simulation, nullptr);
  }
  const auto shipped = std::find(refinements.begin(), refinements.end(), 1.0) - refinements.begin();
  Case whole({"coupled/12-convergence", "Results of whole plans under refinement",
              "The same plans on the finest grid, refined in the plane and through the layers."});
  const std::vector<double> coarser(refinements.begin(), refinements.end() - 1);
  for (const auto& [quantity, figure, bound] : {std::tuple{"lift", &RefinedResult::lift, bounds.lift},
                                                std::tuple{"pressure", &RefinedResult::pressure, bounds.pressure}}) {
    const std::vector<double> errors = errors_against_last(results, figure);
    whole.record({name + ": " + quantity + " at the size that ships", "1", 1.0, 1.0 + errors[shipped], bound});
    whole.record_series({name + ": change of " + quantity + " to the next grid", "refinement", coarser,
                         changes(results, figure), 2.0, bounds.order});
  }
  whole.record({name + ": skin at the size that ships, 95 of 100 points", "mm", 0.1,
                skin_difference(results[shipped], results.back()), 0.0, Bound::kAtMost});
}

}  // namespace lipofill::verification
