#include "server/wire/report_conversion.h"

#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

SessionView view() {
  SessionView view;
  view.report.step = 3;
  view.report.step_size = 0.01;
  view.report.injected = 2e-6;
  view.report.film_volume = 3e-6;
  view.report.max_pressure = 1500;
  view.report.max_thickness = 0.004;
  view.report.skin_max_displacement = 0.0025;
  view.report.skin_speed = 1e-5;
  view.report.skin_volume_change = 1e-6;
  view.report.probe_thickness = {0.001};
  view.report.probe_pressure = {20};
  view.zones = {{"masseter", 1e-6, 100, 0.002}};
  view.state_hash = "hash";
  view.step_ms_median = 9;
  return view;
}

TEST(ReportConversion, SummariesAreInTheUnitsOfTheirNames) {
  const v1::Summary summary = to_summary(view());
  EXPECT_EQ(summary.steps(), 3u);
  EXPECT_DOUBLE_EQ(summary.injected_ml(), 2.0);
  EXPECT_DOUBLE_EQ(summary.film_volume_ml(), 3.0);
  EXPECT_DOUBLE_EQ(summary.max_pressure_pa(), 1500);
  EXPECT_DOUBLE_EQ(summary.max_thickness_mm(), 4.0);
  EXPECT_DOUBLE_EQ(summary.skin_max_displacement_mm(), 2.5);
  EXPECT_DOUBLE_EQ(summary.skin_volume_change_ml(), 1.0);
  EXPECT_DOUBLE_EQ(summary.zones(0).volume_ml(), 1.0);
  EXPECT_DOUBLE_EQ(summary.zones(0).max_thickness_mm(), 2.0);
  EXPECT_EQ(summary.state_hash(), "hash");
}

TEST(ReportConversion, AKeptSpecificationHasTheSizesThatWereChosen) {
  model::FaceModelSpec spec;
  spec.region = geometry::SquareSpec{0.06, 0.04};
  spec.layers = {{"skin", {geometry::ScalarField::constant(2e-3), 0}, {1e5, 0.45, 1100.0}},
                 {"muscle", {geometry::ScalarField::constant(10e-3), 0}, {2e5, 0.45, 1050.0}}};
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  v1::ModelSpec message;
  message.add_layers()->set_name("skin");
  message.add_layers()->set_name("muscle");
  const v1::ModelSpec kept = with_chosen_sizes(message, **model);
  EXPECT_EQ(kept.n_xi(), 46u);
  EXPECT_EQ(kept.n_eta(), 30u);
  EXPECT_EQ(kept.layers(0).elements_through(), 1u);
  EXPECT_EQ(kept.layers(1).elements_through(), 4u);
}

TEST(ReportConversion, TheErrorOfTheGridIsToldOrWhyItIsNotKnown) {
  EXPECT_FALSE(to_summary(view()).has_discretisation_error());
  SessionView settled = view();
  settled.discretisation = simulation::DiscretisationError{0.004, 0.012, 0.02e-3};
  v1::Summary summary = to_summary(settled);
  EXPECT_DOUBLE_EQ(summary.discretisation_error().lift_share(), 0.004);
  EXPECT_DOUBLE_EQ(summary.discretisation_error().pressure_share(), 0.012);
  EXPECT_DOUBLE_EQ(summary.discretisation_error().skin_mm(), 0.02);
  EXPECT_EQ(summary.remarks_size(), 0);
  settled.discretisation = simulation::DiscretisationError{0.01, 0.06, 0.1e-3};
  summary = to_summary(settled);
  ASSERT_EQ(summary.remarks_size(), 1);
  EXPECT_NE(summary.remarks(0).find("a zone's pressure by 6 %"), std::string::npos) << summary.remarks(0);
  settled.discretisation = absl::FailedPreconditionError("the grid has too few divisions to be halved");
  summary = to_summary(settled);
  EXPECT_EQ(summary.discretisation_error().reason(), "the grid has too few divisions to be halved");
  EXPECT_FALSE(summary.discretisation_error().has_lift_share());
}

TEST(ReportConversion, ThePreviewIsToldWhereThereIsOne) {
  EXPECT_FALSE(to_summary(view()).has_preview());
  SessionView previewed = view();
  PreviewView& preview = previewed.preview.emplace();
  EXPECT_EQ(to_summary(previewed).preview().state(), v1::PreviewSummary::PENDING);
  EXPECT_FALSE(to_summary(previewed).preview().has_difference_max_mm());
  preview.state = PreviewState::kDone;
  preview.reason = "at rest";
  preview.report.step = 24;
  preview.report.skin_max_displacement = 0.003;
  preview.report.skin_volume_change = 1.5e-6;
  preview.n_hexahedra = 620;
  preview.n_film_cells = 60;
  preview.wall_s = 0.25;
  preview.difference = simulation::PreviewDifference{0.4e-3, 0.1e-3, -0.02e-6};
  const v1::PreviewSummary summary = to_summary(previewed).preview();
  EXPECT_EQ(summary.state(), v1::PreviewSummary::DONE);
  EXPECT_EQ(summary.reason(), "at rest");
  EXPECT_EQ(summary.steps(), 24u);
  EXPECT_EQ(summary.hexahedra(), 620u);
  EXPECT_EQ(summary.film_cells(), 60u);
  EXPECT_DOUBLE_EQ(summary.wall_s(), 0.25);
  EXPECT_DOUBLE_EQ(summary.skin_max_displacement_mm(), 3.0);
  EXPECT_DOUBLE_EQ(summary.skin_volume_change_ml(), 1.5);
  EXPECT_DOUBLE_EQ(summary.difference_max_mm(), 0.4);
  EXPECT_DOUBLE_EQ(summary.difference_rms_mm(), 0.1);
  EXPECT_DOUBLE_EQ(summary.difference_volume_ml(), -0.02);
  for (const auto state : {PreviewState::kPending, PreviewState::kRunning, PreviewState::kDone, PreviewState::kFailed,
                           PreviewState::kOutdated}) {
    preview.state = state;
    EXPECT_EQ(v1::PreviewSummary::State_Name(to_summary(previewed).preview().state()), preview_state_name(state));
  }
}

TEST(ReportConversion, SeriesRowsAreInTheUnitsOfTheirNames) {
  const v1::SeriesRow row = to_series_row({view().report, 12.5});
  EXPECT_DOUBLE_EQ(row.step_ms(), 10.0);
  EXPECT_DOUBLE_EQ(row.wall_ms(), 12.5);
  EXPECT_DOUBLE_EQ(row.skin_speed_mm_per_s(), 0.01);
  EXPECT_DOUBLE_EQ(row.probe_thickness_mm(0), 1.0);
  EXPECT_DOUBLE_EQ(row.probe_pressure_pa(0), 20);
}

TEST(ReportConversion, CostsOfStepsAreInMillisecondsAndAddUp) {
  mechanics::StepCost step;
  step.times = {0.001, 0.002, 0.003, 0.004, 0.005, 0.016};
  step.factorisations = 1;
  step.tissue_solves = 2;
  step.film_iterations = 3;
  step.newton_iterations = 4;
  step.iterative_iterations = 5;
  step.fallbacks = 6;
  SeriesEntry entry{view().report, 12.5};
  entry.report.cost = step;
  const v1::ComputingCost one = to_series_row(entry).cost();
  EXPECT_DOUBLE_EQ(one.element_cpu_ms(), 1.0);
  EXPECT_DOUBLE_EQ(one.factor_cpu_ms(), 2.0);
  EXPECT_DOUBLE_EQ(one.solve_cpu_ms(), 3.0);
  EXPECT_DOUBLE_EQ(one.film_cpu_ms(), 4.0);
  EXPECT_DOUBLE_EQ(one.coupling_cpu_ms(), 5.0);
  EXPECT_DOUBLE_EQ(one.cpu_ms(), 16.0);
  EXPECT_EQ(one.factorisations(), 1u);
  EXPECT_EQ(one.tissue_solves(), 2u);
  EXPECT_EQ(one.film_iterations(), 3u);
  EXPECT_EQ(one.newton_iterations(), 4u);
  EXPECT_EQ(one.iterative_iterations(), 5u);
  EXPECT_EQ(one.fallbacks(), 6u);
  SessionView whole = view();
  whole.cost.add(step);
  whole.cost.add(step);
  EXPECT_DOUBLE_EQ(to_summary(whole).cost().cpu_ms(), 32.0);
  EXPECT_EQ(to_summary(whole).cost().fallbacks(), 12u);
}

TEST(ReportConversion, EveryStateHasAName) {
  for (int state = 1; state <= 7; ++state) {
    const auto wire = to_state(static_cast<SimulationState>(state));
    EXPECT_EQ(v1::Simulation::State_Name(wire), state_name(static_cast<SimulationState>(state)));
  }
}

TEST(ReportConversion, MeasuresTheTissueOfASkewedGrid) {
  model::FaceModel model;
  geometry::LayeredGrid& grid = model.geometry.grid;
  grid.n_xi = 2;
  grid.n_eta = 1;
  grid.elements_through = {1};
  grid.nodes.resize(3, 12);
  for (int level = 0; level < 2; ++level) {
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 3; ++i)
        grid.nodes.col(grid.node(level, i, j)) << 0.01 * i + 0.004 * j, 0.01 * j, -0.003 * level;
    }
  }
  EXPECT_NEAR(to_model_report(model).tissue_volume_ml(), 0.6, 1e-12) << "a shear keeps volume";
}

TEST(ReportConversion, TellsTheThicknessOfLayersAndWhatWasFoundOfTheBone) {
  model::FaceModel model;
  model.geometry.grid.nodes = Eigen::Matrix3Xd::Zero(3, 1);
  EXPECT_FALSE(to_model_report(model).has_bone());
  model.layers.resize(1);
  model.layers[0].name = "muscle";
  model.thickness = {{2e-3, 5e-3, 9e-3}};
  model.bone = model::BoneFinding{0.9, 0.25, {8e-3, 12e-3, 20e-3}};
  const v1::ModelReport report = to_model_report(model);
  ASSERT_EQ(report.layers_size(), 1);
  EXPECT_EQ(report.layers(0).name(), "muscle");
  EXPECT_DOUBLE_EQ(report.layers(0).min_thickness_mm(), 2.0);
  EXPECT_DOUBLE_EQ(report.layers(0).mean_thickness_mm(), 5.0);
  EXPECT_DOUBLE_EQ(report.layers(0).max_thickness_mm(), 9.0);
  EXPECT_EQ(report.bone().measured_share(), 0.9);
  EXPECT_EQ(report.bone().limited_share(), 0.25);
  EXPECT_DOUBLE_EQ(report.bone().min_depth_mm(), 8.0);
  EXPECT_DOUBLE_EQ(report.bone().mean_depth_mm(), 12.0);
  EXPECT_DOUBLE_EQ(report.bone().max_depth_mm(), 20.0);
}

}  // namespace
}  // namespace lipofill::server
