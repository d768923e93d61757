// `lipofill run` with a daemon of its own: everything a user gets from one command.

#include <signal.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "tests/integration/cli/cli_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

class RunTest : public CliTest {
 protected:
  /// Ends once `name` is there, or after some time.
  void wait_for_file(const std::string& name) const {
    for (int i = 0; i < 1000 && !exists(name); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ASSERT_TRUE(exists(name)) << name;
  }
};

TEST_F(RunTest, WritesWhatParaViewOpens) {
  const CommandResult result = run("lipofill run plan.json --out out --spawn --no-picture");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("0.300 mL injected"));
  EXPECT_THAT(result.output, HasSubstr("Research and planning aid, not a medical device."));
  for (const char* name :
       {"skin_0000.vtp", "skin_0005.vtp", "film_0005.vtp", "tissue_0005.vtu", "skin.pvd", "film.pvd", "tissue.pvd"}) {
    EXPECT_TRUE(exists(std::string("out/") + name)) << name;
  }
  EXPECT_THAT(read("out/skin.pvd"), HasSubstr("timestep=\"0\""));
  EXPECT_THAT(read("out/skin.pvd"), HasSubstr("timestep=\"0.5\""));

  vtkNew<vtkXMLPolyDataReader> skin;
  skin->SetFileName((folder_ / "out/skin_0005.vtp").c_str());
  skin->Update();
  ASSERT_EQ(skin->GetOutput()->GetNumberOfPoints(), 13 * 13);
  double range[2];
  skin->GetOutput()->GetPointData()->GetArray("displacement_mm")->GetRange(range, 2);
  const auto summary = read_json("out/summary.json");
  EXPECT_NEAR(range[1], summary["skin_max_displacement_mm"].get<double>(), 0.2);
  ASSERT_NE(skin->GetOutput()->GetPointData()->GetArray("pressure_pa"), nullptr);

  vtkNew<vtkXMLPolyDataReader> film;
  film->SetFileName((folder_ / "out/film_0005.vtp").c_str());
  film->Update();
  vtkCellData* cells = film->GetOutput()->GetCellData();
  for (const char* name : {"thickness_mm", "pressure_pa", "velocity_mm_per_s", "wet"})
    EXPECT_NE(cells->GetArray(name), nullptr) << name;
  cells->GetArray("thickness_mm")->GetRange(range);
  EXPECT_NEAR(range[1], summary["max_thickness_mm"].get<double>(), 1e-5);

  vtkNew<vtkXMLUnstructuredGridReader> tissue;
  tissue->SetFileName((folder_ / "out/tissue_0005.vtu").c_str());
  tissue->Update();
  EXPECT_EQ(tissue->GetOutput()->GetNumberOfCells(), 144);
}

TEST_F(RunTest, APrivateDaemonIsNotSetUpByTheEnvironmentOfAnother) {
  const CommandResult result =
      run("env LIPOFILLD_WORKERS=none LIPOFILLD_CONFIG=/none lipofill run plan.json --out out --spawn --no-picture");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
}

TEST_F(RunTest, SummaryAndSeriesAgreeAndTwoRunsAreTheSame) {
  const auto summary = answer_of("lipofill run plan.json --out a --spawn --no-picture --quiet");
  EXPECT_EQ(summary, read_json("a/summary.json"));
  EXPECT_EQ(summary["plan"], "square");
  EXPECT_EQ(summary["state"], "FINISHED");
  EXPECT_EQ(summary["steps"], 50);
  EXPECT_NEAR(summary["injected_ml"].get<double>(), 0.3, 1e-12);
  EXPECT_LT(summary["film_volume_relative_error"].get<double>(), 1e-10);
  EXPECT_LT(summary["gap_volume_relative_error"].get<double>(), 1e-4);
  EXPECT_EQ(summary["zones"][0]["name"], "middle");

  const std::string series = read("a/series.csv");
  EXPECT_EQ(std::count(series.begin(), series.end(), '\n'), 51);
  EXPECT_THAT(series, ::testing::StartsWith("step,time_s,"));
  EXPECT_THAT(series, HasSubstr("probe_centre_thickness_mm"));

  const auto again = answer_of("lipofill run plan.json --out b --spawn --no-picture --quiet --interval-ms 0");
  EXPECT_EQ(again["state_hash"], summary["state_hash"]);
  EXPECT_EQ(again["state_hash"].get<std::string>().size(), 64u);
  EXPECT_TRUE(exists("b/skin_0001.vtp"));
  EXPECT_FALSE(exists("b/skin_0002.vtp"));
}

TEST_F(RunTest, FastGivesTheSettledShapeInFewSteps) {
  write_plan("settles.json", "/simulation/time",
             {{"step_ms", 10}, {"max_step_ms", 100}, {"end_s", 300}, {"settle_skin_speed_mm_per_s", 0.01}});
  const std::string options = " --spawn --discard --no-picture --quiet --interval-ms 0";
  const auto watched = answer_of("lipofill run settles.json --out a" + options);
  const auto fast = answer_of("lipofill run settles.json --out b --fast" + options);
  EXPECT_EQ(watched["state"], "SETTLED");
  EXPECT_EQ(fast["state"], "SETTLED");
  EXPECT_LT(3 * fast["steps"].get<int>(), watched["steps"].get<int>());
  EXPECT_NEAR(fast["injected_ml"].get<double>(), 0.3, 1e-12);
  EXPECT_LT(fast["gap_volume_relative_error"].get<double>(), 1e-4);
  EXPECT_NEAR(fast["skin_max_displacement_mm"].get<double>(), watched["skin_max_displacement_mm"].get<double>(), 0.12)
      << "at 0.01 mm/s the watched one has a tenth of a millimetre still to go";
}

TEST_F(RunTest, PreviewIsToldFirstAndMeasuredInTheEnd) {
  write_plan("settles.json", "/simulation/time",
             {{"step_ms", 10}, {"max_step_ms", 100}, {"end_s", 300}, {"settle_skin_speed_mm_per_s", 0.05}});
  const std::string options = " --spawn --discard --no-picture --interval-ms 0";
  const auto plain = answer_of("lipofill run settles.json --out a --quiet" + options);
  EXPECT_TRUE(plain["preview"].is_null());
  const CommandResult result = run("lipofill run settles.json --out b --preview" + options);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("preview: skin moved "));
  EXPECT_THAT(result.output, HasSubstr("mm from the result at most"));
  EXPECT_TRUE(exists("b/skin_preview.vtp"));
  const auto summary = read_json("b/summary.json");
  EXPECT_EQ(summary["state_hash"], plain["state_hash"]) << "the preview changes nothing";
  EXPECT_EQ(summary["preview"]["state"], "DONE");
  EXPECT_LT(summary["preview"]["difference_max_mm"].get<double>(), summary["skin_max_displacement_mm"].get<double>());
  EXPECT_LE(summary["preview"]["difference_rms_mm"].get<double>(),
            summary["preview"]["difference_max_mm"].get<double>());
}

TEST_F(RunTest, APreviewThatCannotBeIsToldAndTheRunGoesOn) {
  // A zone between the centres of the coarse film's cells.
  auto plan = read_json("plan.json");
  plan["simulation"]["films"][0]["zones"][0]["box"] = {
      {"xi_min", 0.38}, {"xi_max", 0.45}, {"eta_min", 0.16}, {"eta_max", 0.84}};
  plan["simulation"]["injections"][0]["site"]["chart"]["xi"] = 0.42;
  plan["simulation"]["injections"][0]["volume_ml"] = 0.05;
  plan["simulation"].erase("probes");
  write("narrow.json", plan.dump());
  const CommandResult result = run("lipofill run narrow.json --out out --preview --spawn --discard --no-picture");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("preview      FAILED, the coarse model cannot hold the plan"));
  EXPECT_EQ(read_json("out/summary.json")["state"], "FINISHED");
}

TEST_F(RunTest, DrawsAndEvaluatesTheFolder) {
  write_plane("goal.obj", 1.0);
  const CommandResult made = run("lipofill run plan.json --out out --spawn");
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  EXPECT_EQ(read("out/picture.png").substr(1, 3), "PNG") << made.errors;

  const auto evaluation = answer_of("lipofill evaluate out --target goal.obj");
  // The square's skin lies at z = 0 before, everywhere 1 mm from the goal.
  EXPECT_NEAR(evaluation["before_to_target"]["max_mm"].get<double>(), 1.0, 1e-6);
  EXPECT_NEAR(evaluation["before_to_target"]["signed_mean_mm"].get<double>(), -1.0, 1e-6);
  EXPECT_EQ(evaluation["before_to_target"]["share_under_2_mm"].get<double>(), 1.0);
  EXPECT_NEAR(evaluation["volume_before"]["deficit_ml"].get<double>(), 1.6, 1e-4);
  EXPECT_EQ(evaluation["points"], 13 * 13);
  EXPECT_EQ(evaluation, read_json("out/evaluation.json"));
  EXPECT_EQ(read("out/distance.png").substr(1, 3), "PNG");
  EXPECT_EQ(run("lipofill evaluate out --target goal.obj --require 'hausdorff_mm<=100'").exit_code, 0);
  const CommandResult missed = run("lipofill evaluate out --target goal.obj --require 'max_mm<=0.001'");
  EXPECT_EQ(missed.exit_code, 1);
  EXPECT_THAT(missed.errors, HasSubstr("required max_mm<=0.001, it is "));
  EXPECT_EQ(run("lipofill evaluate out --target goal.obj --require 'nose<=1'").exit_code, 2);

  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder_ / "out/distance.vtp").c_str());
  reader->Update();
  vtkDataArray* distance = reader->GetOutput()->GetPointData()->GetArray("distance_mm");
  ASSERT_NE(distance, nullptr);
  double squares = 0.0;
  for (vtkIdType i = 0; i < distance->GetNumberOfTuples(); ++i) squares += std::pow(distance->GetComponent(i, 0), 2);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(distance->GetNumberOfTuples())),
              evaluation["simulated_to_target"]["rms_mm"].get<double>(), 1e-3);
  // At the clamped rim the skin is still at 0, below the goal.
  EXPECT_NEAR(distance->GetComponent(0, 0), -1.0, 1e-5);
}

TEST_F(RunTest, DiscardLeavesOnlyTheFiles) {
  ASSERT_EQ(run("lipofill run plan.json --out out --spawn --discard --no-picture --quiet").exit_code, 0);
  EXPECT_FALSE(exists("out/.lipofilld"));
  EXPECT_TRUE(exists("out/summary.json"));
  write_plane("goal.obj", 1.0);
  const CommandResult result = run("lipofill evaluate out --target goal.obj");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.errors, HasSubstr("did not keep its simulation"));
}

TEST_F(RunTest, AFailedSimulationIsAResultWithExitCode1) {
  // Fat pressed between rigid walls has nowhere to go.
  write_plan(
      "burst.json", "/simulation/films/0",
      {{"name", "film"},
       {"wall", {{"kind", "RIGID"}}},
       {"n_xi", 4},
       {"n_eta", 4},
       {"rest_thickness_mm", {{"constant", 1.0}}},
       {"zones", {{{"name", "middle"}, {"box", {{"xi_min", 0}, {"xi_max", 1}, {"eta_min", 0}, {"eta_max", 1}}}}}}});
  const CommandResult result = run("lipofill run burst.json --out out --spawn --no-picture");
  EXPECT_EQ(result.exit_code, 1) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("square: FAILED ("));
  const auto summary = read_json("out/summary.json");
  EXPECT_EQ(summary["state"], "FAILED");
  EXPECT_NE(summary["reason"], "");
  EXPECT_TRUE(exists("out/skin_0000.vtp"));
}

TEST_F(RunTest, InterruptStopsTheSimulationAndTheDaemon) {
  write_plan("long.json", "/simulation/time/end_s", 100000.0);
  Command command(in_folder("lipofill run long.json --out out --spawn --no-picture"));
  wait_for_file("out/skin_0002.vtp");
  command.signal(SIGINT);
  const CommandResult result = command.wait();
  EXPECT_EQ(result.exit_code, 130) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("interrupted"));
  EXPECT_EQ(read_json("out/summary.json")["state"], "STOPPED");
  // The private daemon is gone: its folder can be served by another.
  write_plane("goal.obj", 1.0);
  const CommandResult evaluated = run("lipofill evaluate out --target goal.obj");
  EXPECT_EQ(evaluated.exit_code, 0) << evaluated.errors;
}

}  // namespace
}  // namespace lipofill::testing
