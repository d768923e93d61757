// Nothing that a step does for every hexahedron, film cell or edge takes memory from the heap once
// it has run.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/coupling/gap_system.h"
#include "core/film/advection.h"
#include "core/film/edge_thickness.h"
#include "core/film/film_projection.h"
#include "core/film/viscosity.h"
#include "core/mechanics/tissue_setup.h"
#include "core/solid/hex_quality.h"
#include "tests/unit/simulation/allocation_counter.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

using lipofill::testing::count_allocations_of;

TEST(AllocationCounter, SeesVectorsMatricesAndStrings) {
  EXPECT_EQ(count_allocations_of([] { std::vector<int>(100, 1).resize(10); }), 1);
  EXPECT_EQ(count_allocations_of([] { Eigen::VectorXd::Ones(100).eval(); }), 1);
  EXPECT_EQ(count_allocations_of([] { std::string(100, 'a').clear(); }), 1);
  EXPECT_EQ(count_allocations_of([] { Eigen::Vector3d::Ones().eval(); }), 0);
}

/// All that a step may come across: tension at rest, a ligament, connective tissue, springs below,
/// walls that leak.
struct Everything {
  std::shared_ptr<const model::FaceModel> model;
  plan::SimulationSpec spec = make_small_plan();
  std::vector<plan::FilmLayout> films;
  std::unique_ptr<mechanics::TissueSetup> setup;
  std::unique_ptr<coupling::GapSystem> gaps;
  Eigen::Matrix3Xd x;

  Everything() {
    model::FaceModelSpec model_spec = make_small_model_spec();
    model_spec.layers[0].material.prestress = 1e3;
    model_spec.base = {model::SupportKind::kElastic, 1e7};
    model = model::build_face_model(model_spec, nullptr).value();
    spec.films[0].walls = {{"septum", {geometry::ChartPoint{0.4, 0.0}, geometry::ChartPoint{0.4, 1.0}}, {}, 1e-9}};
    spec.films[0].connective_tissue = {1e6, 100.0};
    plan::LigamentSpec ligament;
    ligament.name = "post";
    ligament.place = std::vector<geometry::SkinPoint>{geometry::ChartPoint{0.55, 0.5}};
    ligament.stiffness = 50.0;
    spec.ligaments = {ligament};
    films.push_back(plan::place_film(*model, spec.films[0]).value());
    setup = std::make_unique<mechanics::TissueSetup>(mechanics::set_up_tissue(*model, films, spec).value());
    const solid::Tissue& tissue = setup->tissue;
    std::vector<coupling::GapVolume> gap;
    gap.emplace_back(model->geometry.grid, setup->walls[0], films[0].grid, tissue.dof_of_component(), tissue.n_dofs());
    gaps = std::make_unique<coupling::GapSystem>(std::move(gap), tissue.n_dofs());
    x = tissue.mesh().rest_positions;
    for (Eigen::Index n = 0; n < x.cols(); ++n) x(2, n) += 1e-3 * std::sin(80.0 * x(0, n)) * (1.0 + 30.0 * x(2, n));
  }
};

/// What `call` takes from the heap once it has run.
long count_when_warm(const std::function<void()>& call) {
  call();
  return count_allocations_of(call);
}

TEST(Allocations, TissueTakesNone) {
  Everything all;
  solid::Tissue& tissue = all.setup->tissue;
  ASSERT_GT(tissue.n_springs(), 1);
  Eigen::Matrix3Xd crushed = all.x;
  crushed.row(2) *= 0.05;
  EXPECT_EQ(count_when_warm([&] { tissue.compute_force(all.x); }), 0);
  EXPECT_EQ(count_when_warm([&] { tissue.assemble(all.x, 0.01); }), 0);
  // The barrier of a hexahedron squeezed flat takes none either, at the first time already.
  EXPECT_EQ(count_allocations_of([&] { tissue.assemble(crushed, 0.01); }), 0);
  EXPECT_EQ(count_when_warm([&] { solid::compute_min_scaled_jacobian(tissue.mesh(), all.x); }), 0);
  const Eigen::VectorXd moved = Eigen::VectorXd::Ones(tissue.n_dofs());
  Eigen::VectorXd product;
  EXPECT_EQ(count_when_warm([&] { tissue.stiffness_times(moved, product); }), 0);
}

TEST(Allocations, GapsAndMidSurfaceTakeNone) {
  Everything all;
  film::FilmMetric metric;
  EXPECT_EQ(count_when_warm([&] { all.gaps->evaluate(all.x); }), 0);
  EXPECT_EQ(count_when_warm([&] { all.gaps->evaluate_volume(all.x); }), 0);
  EXPECT_EQ(count_when_warm([&] {
              all.gaps->film(0).mid_surface(all.x, metric.vertices);
              film::update_film_metric(all.films[0].grid, metric);
            }),
            0);
}

TEST(Allocations, MotionOfTheFilmTakesNone) {
  const Everything all;
  const film::FilmGrid& grid = all.films[0].grid;
  const film::FilmMetric metric = film::compute_film_metric(grid, all.gaps->film(0).mid_surface(all.x));
  const Eigen::VectorXd h = Eigen::VectorXd::LinSpaced(grid.n_cells(), 1e-4, 2e-3);
  const Eigen::VectorXd velocity = Eigen::VectorXd::LinSpaced(grid.n_edges(), -1e-5, 1e-5);
  film::ImplicitViscosity viscosity(grid);
  film::Advection advection(grid);
  Eigen::VectorXd edge_h, viscous, next;
  EXPECT_EQ(count_when_warm([&] {
              film::compute_edge_thickness(grid, h, velocity, edge_h);
              viscosity.advance(grid, metric, {}, h, edge_h, velocity, 0.01, viscous);
              advection.advance(metric, viscous, 0.01, next);
            }),
            0);
}

class ProjectionAllocations : public ::testing::TestWithParam<film::Fat> {};

TEST_P(ProjectionAllocations, AreNone) {
  const Everything all;
  const film::FilmGrid& grid = all.films[0].grid;
  ASSERT_FALSE(grid.leaky_walls.empty());
  const film::FilmMetric metric = film::compute_film_metric(grid, all.gaps->film(0).mid_surface(all.x));
  const Eigen::VectorXd volume = 1e-3 * metric.area;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(grid.n_edges());
  const Eigen::VectorXd stress = Eigen::VectorXd::Ones(grid.n_edges());
  const Eigen::VectorXd pressure = Eigen::VectorXd::LinSpaced(grid.n_cells(), -1e3, 1e3);
  film::FilmProjection projection(grid);
  Eigen::VectorXd flux = none, next(grid.n_cells()), velocity, next_stress;
  EXPECT_EQ(count_when_warm([&] {
              film::FilmStepInput& input = projection.next_input();
              input.metric = &metric;
              input.fat = GetParam();
              input.volume = input.injected = volume;
              input.velocity = input.body_force = none;
              input.dt = 0.01;
              input.wall_stress = stress;
              input.is_closed.assign(grid.n_cells(), 0);
              projection.begin_step();
              projection.set_thickness(volume, flux);
              projection.linearise(pressure);
              projection.compute_flux(pressure, flux);
              projection.compute_volume(flux, next);
              projection.compute_velocity(flux, velocity);
              projection.compute_wall_stress(pressure, next_stress);
            }),
            0);
}

constexpr double kStiff = std::numeric_limits<double>::infinity();
INSTANTIATE_TEST_SUITE_P(Fats, ProjectionAllocations,
                         ::testing::Values(film::Fat{15.0, 920.0, film::WallFriction::kNoSlip},
                                           film::Fat{15.0, 920.0, film::WallFriction::kNoSlip, 0.5, 50.0, kStiff},
                                           film::Fat{15.0, 920.0, film::WallFriction::kNoSlip, 1.0, 0.0, 70.0}));

}  // namespace
}  // namespace lipofill::simulation
