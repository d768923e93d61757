// The coarser model and plan of a preview.

#include "core/plan/coarse_plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/plan/film_layout.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

std::shared_ptr<const model::FaceModel> build(const model::FaceModelSpec& spec) {
  auto model = model::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return model.ok() ? *model : nullptr;
}

std::shared_ptr<const model::FaceModel> build_square(int n_xi, int n_eta) {
  model::FaceModelSpec spec = make_small_model_spec();
  spec.n_xi = n_xi;
  spec.n_eta = n_eta;
  // The lower layer grows thicker along xi.
  spec.layers[1].geometry = {geometry::ScalarField{2, 1, {4e-3, 8e-3}}, 2};
  return build(spec);
}

/// Volume under the skin by the depth of the last level at the nodes, trapezoids [m3].
double volume_of(const geometry::LayeredGrid& grid) {
  double volume = 0.0;
  const double area = 0.048 / grid.n_xi * 0.048 / grid.n_eta;
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      const double share = (i % grid.n_xi == 0 ? 0.5 : 1.0) * (j % grid.n_eta == 0 ? 0.5 : 1.0);
      volume -= share * area * grid.nodes(2, grid.node(grid.n_levels() - 1, i, j));
    }
  }
  return volume;
}

TEST(CoarseModel, KeepsShapeLayersAndSupportsOfTheModel) {
  const auto fine = build_square(40, 31);
  const auto coarse = plan::coarsen_model(*fine);
  const geometry::LayeredGrid& grid = coarse->geometry.grid;
  EXPECT_EQ(grid.n_xi, 20);
  EXPECT_EQ(grid.n_eta, 16) << "an even number";
  EXPECT_EQ(grid.elements_through, fine->geometry.grid.elements_through);
  EXPECT_EQ(coarse->layers.size(), fine->layers.size());
  EXPECT_TRUE(coarse->is_square);
  EXPECT_NEAR(volume_of(grid), volume_of(fine->geometry.grid), 1e-12);
  EXPECT_NEAR(volume_of(grid), 0.048 * 0.048 * 8e-3, 1e-12);
  EXPECT_GT(grid.min_scaled_jacobian, 0.9);
  EXPECT_NE(coarse->content_hash, fine->content_hash);
  EXPECT_EQ(coarse->content_hash, plan::coarsen_model(*fine)->content_hash);
}

TEST(CoarseModel, IsBoundedHoweverFineTheModel) {
  const auto coarse = plan::coarsen_model(*build_square(150, 120));
  EXPECT_LE(coarse->geometry.grid.n_hexahedra(), 1.1 * plan::kMostPreviewHexahedra);
  EXPECT_GE(coarse->geometry.grid.n_hexahedra(), 0.8 * plan::kMostPreviewHexahedra);
  const auto tiny = plan::coarsen_model(*build_square(6, 10));
  EXPECT_EQ(tiny->geometry.grid.n_xi, 6);
  EXPECT_EQ(tiny->geometry.grid.n_eta, plan::kLeastPreviewDivisions);
}

TEST(CoarsePlan, CellsShareTheirEdgesWithTheHexahedraAndAreCoarseEnough) {
  for (const auto& [n_xi, n_eta] : {std::pair(40, 31), {23, 37}, {12, 12}, {90, 14}}) {
    const auto fine = build_square(n_xi, n_eta);
    const auto coarse = plan::coarsen_model(*fine);
    const geometry::LayeredGrid& grid = coarse->geometry.grid;
    for (const geometry::ChartBox& extent :
         {geometry::ChartBox{}, geometry::ChartBox{0.1, 0.83, 0.2, 1.0}, geometry::ChartBox{0.4, 0.97, 0.0, 0.5}}) {
      plan::SimulationSpec spec = make_small_plan();
      spec.films[0].extent = extent;
      spec.films[0].n_xi = static_cast<int>((extent.xi_max - extent.xi_min) * n_xi / 2.0);
      spec.films[0].n_eta = static_cast<int>((extent.eta_max - extent.eta_min) * n_eta / 3.0);
      ASSERT_TRUE(plan::place_film(*fine, spec.films[0]).ok());
      const plan::FilmSpec film = plan::coarsen_plan(spec, *fine, *coarse).films[0];
      EXPECT_TRUE(plan::place_film(*coarse, film).ok()) << plan::place_film(*coarse, film).status();
      for (const auto& [low, high, n, n_tissue] :
           {std::tuple(film.extent.xi_min, film.extent.xi_max, film.n_xi, grid.n_xi),
            std::tuple(film.extent.eta_min, film.extent.eta_max, film.n_eta, grid.n_eta)}) {
        const double across = (high - low) * n_tissue / n;
        EXPECT_NEAR(across, std::round(across), 1e-9);
        EXPECT_NEAR(low * n_tissue, std::round(low * n_tissue), 1e-9);
        EXPECT_GE(low, 0.0);
        EXPECT_LE(high, 1.0 + 1e-12);
      }
      EXPECT_NEAR(film.extent.xi_min, extent.xi_min, 2.0 / grid.n_xi);
      EXPECT_NEAR(film.extent.xi_max, extent.xi_max, 2.0 / grid.n_xi);
    }
  }
}

TEST(CoarsePlan, KeepsTheContentOfAnUnevenFilm) {
  const auto fine = build_square(24, 24);
  const auto coarse = plan::coarsen_model(*fine);
  plan::SimulationSpec spec = make_small_plan();
  spec.films[0].n_xi = spec.films[0].n_eta = 12;
  // A ridge narrower than a coarse cell, off its centres.
  spec.films[0].initial_thickness = geometry::ScalarField{49, 1, std::vector<double>(49, 1e-3)};
  for (int k = 20; k < 23; ++k) spec.films[0].initial_thickness->values[k] = 5e-3;
  const auto content = [](const model::FaceModel& model, const plan::FilmSpec& film) {
    const auto layout = plan::place_film(model, film);
    double sum = 0.0;
    for (int cell = 0; cell < layout->grid.n_cells(); ++cell) {
      const geometry::ChartPoint centre = layout->cell_centre(cell);
      sum += layout->initial_thickness.at(centre.xi, centre.eta);
    }
    return sum / layout->grid.n_cells();
  };
  const plan::SimulationSpec plan = plan::coarsen_plan(spec, *fine, *coarse);
  const double mean = 1e-3 + 4e-3 * 3.0 / 48.0;
  EXPECT_NEAR(content(*coarse, plan.films[0]), mean, 0.02 * mean);
  EXPECT_GT(std::abs(content(*fine, spec.films[0]) - mean), 0.05 * mean) << "the fine plan itself samples at centres";
}

TEST(CoarsePlan, TakesLongStepsMovesSitesIntoTheirZoneAndKeepsInjections) {
  const auto fine = build_square(24, 24);
  const auto coarse = plan::coarsen_model(*fine);
  plan::SimulationSpec spec = make_small_plan();
  spec.films[0].n_xi = spec.films[0].n_eta = 12;
  spec.films[0].zones = {{"low", geometry::ChartBox{0.0, 0.45, 0.0, 1.0}},
                         {"high", geometry::ChartBox{0.45, 1.0, 0.0, 1.0}}};
  spec.injections = {{"high", 0.1e-6, 1e-6, 0.25, geometry::ChartPoint{0.46, 0.3}}};
  const plan::SimulationSpec plan = plan::coarsen_plan(spec, *fine, *coarse);
  EXPECT_EQ(plan.goal, plan::TimeGoal::kSettledShape);
  EXPECT_GT(*plan.max_injection_step, spec.step);
  EXPECT_EQ(plan.end, spec.end);
  EXPECT_TRUE(plan.probes.empty());
  EXPECT_EQ(plan.injections[0].volume, spec.injections[0].volume);
  EXPECT_EQ(plan.injections[0].start, spec.injections[0].start);
  const auto layout = plan::place_film(*coarse, plan.films[0]);
  ASSERT_TRUE(layout.ok());
  const auto site = std::get<geometry::ChartPoint>(*plan.injections[0].site);
  const int cell = layout->cell_at(site);
  ASSERT_GE(cell, 0);
  EXPECT_EQ(layout->zone_names[layout->grid.zone_of_cell[cell]], "high");
  EXPECT_NEAR(site.eta, 0.3, 1.0 / 12);
}

}  // namespace
}  // namespace lipofill::simulation
