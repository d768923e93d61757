// A plan that is only looked at: where its zones are and what is wrong with it, and nothing is
// made.

#include <cstring>

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

class PlanCheckTest : public RunTest {
 protected:
  grpc::Status check(const v1::SimulationSpec& spec, v1::CheckPlanResponse& response) {
    v1::CheckPlanRequest request;
    *request.mutable_spec() = spec;
    return call(*simulations_, &v1::SimulationService::Stub::CheckPlan, request, response);
  }
  int count_simulations() {
    v1::ListSimulationsResponse response;
    EXPECT_TRUE(
        call(*simulations_, &v1::SimulationService::Stub::ListSimulations, v1::ListSimulationsRequest(), response)
            .ok());
    return response.simulations_size();
  }
};

TEST_F(PlanCheckTest, FindsZonesWhereASimulationHasThem) {
  const v1::SimulationSpec spec = square_plan(model_.name(), 1.0);
  v1::CheckPlanResponse response;
  const grpc::Status status = check(spec, response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.violations_size(), 0) << response.ShortDebugString();
  ASSERT_EQ(response.zones_size(), 1);
  EXPECT_EQ(response.zones(0).name(), "middle");
  EXPECT_EQ(response.zones(0).film_cells(), 9u);
  EXPECT_GT(response.zones(0).area_cm2(), 0.0);
  ASSERT_EQ(response.zones(0).outline_size(), 1);
  EXPECT_GE(response.zones(0).outline(0).points_mm_size(), 12) << "around three by three cells";
  EXPECT_EQ(count_simulations(), 0);

  v1::Simulation simulation;
  ASSERT_TRUE(create_simulation(spec, "x", false, simulation).ok());
  v1::WatchRequest request = watch_request("simulations/x", v1::WatchRequest::LATEST);
  request.add_fields("skin.zone");
  Watcher watcher(*channel_, request);
  SeenFrame frame;
  ASSERT_TRUE(watcher.next(frame));
  const std::string& bytes = frame.bytes.at("skin.zone");
  std::vector<float> shown(bytes.size() / sizeof(float));
  std::memcpy(shown.data(), bytes.data(), bytes.size());
  EXPECT_EQ(std::vector<float>(response.zone_under_skin_point().begin(), response.zone_under_skin_point().end()),
            shown);
}

TEST_F(PlanCheckTest, TellsOfABadPlanAllThatCreationWouldRefuse) {
  v1::SimulationSpec spec = square_plan(model_.name(), 1.0);
  spec.mutable_fat()->set_density_kg_m3(-1.0);
  spec.mutable_injections(0)->set_volume_ml(1e4);
  v1::CheckPlanResponse response;
  ASSERT_TRUE(check(spec, response).ok());
  v1::Simulation simulation;
  const auto refused = violations_of(create_simulation(spec, "x", false, simulation));
  std::map<std::string, std::string> told;
  for (const v1::PlanFinding& finding : response.violations()) told[finding.field()] = finding.description();
  EXPECT_EQ(told, refused);
  EXPECT_TRUE(told.contains("spec.fat.density_kg_m3"));
  EXPECT_TRUE(told.contains("spec.injections[0].volume_ml"));
  EXPECT_EQ(response.zones_size(), 1) << "the zones are there all the same";
}

TEST_F(PlanCheckTest, TellsWhatThePlanLeavesOutAndRemarksOnTheRest) {
  v1::SimulationSpec spec = square_plan(model_.name(), 1.0);
  spec.mutable_injections(0)->clear_rate_ml_per_s();
  v1::CheckPlanResponse response;
  ASSERT_TRUE(check(spec, response).ok());
  ASSERT_EQ(response.violations_size(), 1);
  EXPECT_EQ(response.violations(0).field(), "spec.injections[0].rate_ml_per_s");
  spec = square_plan(model_.name(), 1e-3);
  ASSERT_TRUE(check(spec, response).ok());
  ASSERT_EQ(response.remarks_size(), 1);
  EXPECT_EQ(response.remarks(0).field(), "spec.time.end_s");
}

TEST_F(PlanCheckTest, NeedsAPlanAndItsModel) {
  v1::CheckPlanResponse response;
  EXPECT_EQ(check(square_plan("patients/anna/models/none", 1.0), response).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(check(square_plan("face", 1.0), response).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  v1::SimulationSpec large = square_plan(model_.name(), 1.0);
  large.mutable_films(0)->set_n_xi(60'000);
  large.mutable_films(0)->set_n_eta(60'000);
  EXPECT_EQ(check(large, response).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
}

}  // namespace
}  // namespace lipofill::testing
