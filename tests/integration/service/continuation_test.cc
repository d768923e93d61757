// Life after a simulation has settled: an injection goes on with it, through restarts and crashes,
// and what was injected is in its plan.

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

class ContinuationTest : public RunTest {
 protected:
  v1::SimulationSpec plan(bool direct) const {
    v1::SimulationSpec spec = square_plan(model_.name(), 60.0);
    if (direct) {
      spec.clear_time();
      spec.mutable_time()->set_goal(v1::TimeControl::SETTLED_SHAPE);
    } else {
      spec.mutable_time()->set_settle_skin_speed_mm_per_s(0.5);
    }
    return spec;
  }
  v1::Simulation run(const v1::SimulationSpec& spec, const std::string& id) {
    v1::Simulation simulation;
    const grpc::Status created = create_simulation(spec, id, true, simulation);
    EXPECT_TRUE(created.ok()) << created.error_message();
    return await_end("simulations/" + id);
  }
  grpc::Status inject(const std::string& name, double volume_ml, v1::Simulation* result = nullptr,
                      const std::string& request_id = "", bool validate_only = false) {
    v1::InjectRequest request;
    request.set_name(name);
    request.set_request_id(request_id);
    request.set_validate_only(validate_only);
    request.mutable_injection()->set_zone("middle");
    request.mutable_injection()->set_volume_ml(volume_ml);
    request.mutable_injection()->set_rate_ml_per_s(1.0);
    v1::Simulation simulation;
    const grpc::Status status = call(*simulations_, &v1::SimulationService::Stub::Inject, request, simulation);
    if (result != nullptr) *result = simulation;
    return status;
  }
};

TEST_F(ContinuationTest, ASettledShapeTakesMoreFatAndGivesItBack) {
  const v1::Simulation settled = run(plan(true), "x");
  ASSERT_EQ(settled.state(), v1::Simulation::SETTLED) << settled.reason();
  v1::Simulation went_on;
  const grpc::Status status = inject("simulations/x", 0.05, &went_on);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(went_on.spec().injections_size(), settled.spec().injections_size() + 1);
  const v1::Simulation more = await_end("simulations/x");
  ASSERT_EQ(more.state(), v1::Simulation::SETTLED) << more.reason();
  EXPECT_NEAR(more.summary().film_volume_ml(), settled.summary().film_volume_ml() + 0.05, 1e-9);
  EXPECT_GT(more.summary().skin_max_displacement_mm(), settled.summary().skin_max_displacement_mm());
  EXPECT_GT(more.summary().time_s(), settled.summary().time_s());
  EXPECT_EQ(more.summary().way(), "directly");
  EXPECT_EQ(series("simulations/x").rows_size(), 2) << "a row for each shape";
  ASSERT_TRUE(inject("simulations/x", -0.05).ok());
  const v1::Simulation back = await_end("simulations/x");
  EXPECT_NEAR(back.summary().film_volume_ml(), settled.summary().film_volume_ml(), 1e-9);
  EXPECT_NEAR(back.summary().skin_max_displacement_mm(), settled.summary().skin_max_displacement_mm(), 0.003);

  // The plan that it came to gives the same shape at once.
  const v1::Simulation again = run(back.spec(), "y");
  EXPECT_NEAR(again.summary().max_pressure_pa(), back.summary().max_pressure_pa(),
              1e-2 * back.summary().max_pressure_pa());
}

TEST_F(ContinuationTest, ASteppedRunGoesOnInSteps) {
  const v1::Simulation settled = run(plan(false), "x");
  ASSERT_EQ(settled.state(), v1::Simulation::SETTLED) << settled.reason();
  ASSERT_TRUE(inject("simulations/x", 0.05).ok());
  const v1::Simulation more = await_end("simulations/x");
  ASSERT_EQ(more.state(), v1::Simulation::SETTLED) << more.reason();
  EXPECT_GT(more.summary().steps(), settled.summary().steps() + 5);
  EXPECT_NEAR(more.summary().film_volume_ml(), settled.summary().film_volume_ml() + 0.05, 1e-9);
  const v1::GetSeriesResponse rows = series("simulations/x");
  ASSERT_EQ(static_cast<uint64_t>(rows.rows_size()), more.summary().steps());
  for (int k = 0; k < rows.rows_size(); ++k) EXPECT_EQ(rows.rows(k).step(), static_cast<uint64_t>(k) + 1);
}

TEST_F(ContinuationTest, ItIsRepeatedOnceAndForeseenWithoutAnything) {
  run(plan(true), "x");
  v1::Simulation foreseen;
  ASSERT_TRUE(inject("simulations/x", 0.05, &foreseen, "", true).ok());
  EXPECT_EQ(foreseen.state(), v1::Simulation::SETTLED);
  EXPECT_EQ(foreseen.spec().injections_size(), 2);
  EXPECT_EQ(get_simulation("simulations/x").spec().injections_size(), 1) << "nothing was added";
  ASSERT_TRUE(inject("simulations/x", 0.05, nullptr, "once").ok());
  ASSERT_TRUE(inject("simulations/x", 0.05, nullptr, "once").ok());
  await_end("simulations/x");
  ASSERT_TRUE(inject("simulations/x", 0.05, nullptr, "once").ok());
  EXPECT_EQ(await_end("simulations/x").spec().injections_size(), 2);
}

TEST_F(ContinuationTest, ARefusedInjectionLeavesItSettled) {
  const v1::Simulation settled = run(plan(true), "x");
  EXPECT_TRUE(violations_of(inject("simulations/x", 1e4)).contains("injection.volume_ml"));
  const v1::Simulation after = get_simulation("simulations/x");
  EXPECT_EQ(after.state(), v1::Simulation::SETTLED);
  EXPECT_EQ(after.summary().state_hash(), settled.summary().state_hash());
  EXPECT_EQ(after.etag(), settled.etag());
}

TEST_F(ContinuationTest, OnlyWhatHasSettledGoesOn) {
  v1::Simulation simulation;
  ASSERT_TRUE(create_simulation(square_plan(model_.name(), 0.005), "x", true, simulation).ok());
  ASSERT_EQ(await_end("simulations/x").state(), v1::Simulation::FINISHED);
  const grpc::Status refused = inject("simulations/x", 0.05);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(refused.error_message(), HasSubstr("FINISHED"));
}

/// Killed at once after an acknowledged injection: it comes to the state of one that was not.
TEST_F(ContinuationTest, SurvivesAKillToTheSameBytes) {
  for (const bool direct : {true, false}) {
    SCOPED_TRACE(direct ? "directly" : "in steps");
    const std::string mode = direct ? "d" : "s";
    for (const std::string id : {"a" + mode, "b" + mode}) {
      ASSERT_EQ(run(plan(direct), id).state(), v1::Simulation::SETTLED);
      ASSERT_TRUE(inject("simulations/" + id, 0.05).ok());
      if (id[0] == 'b') restart_hard();
      ASSERT_EQ(await_end("simulations/" + id).state(), v1::Simulation::SETTLED);
    }
    const v1::Simulation undisturbed = get_simulation("simulations/a" + mode);
    const v1::Simulation killed = get_simulation("simulations/b" + mode);
    EXPECT_EQ(killed.summary().state_hash(), undisturbed.summary().state_hash());
    EXPECT_EQ(killed.spec().injections_size(), 2);
    EXPECT_EQ(series(killed.name()).rows_size(), series(undisturbed.name()).rows_size());
  }
}

}  // namespace
}  // namespace lipofill::testing
