// Proposals over the network: an operation with progress that can be cancelled, whose plan runs to
// the shape it tells of; injection lists.

#include <cmath>

#include "absl/strings/str_cat.h"
#include "lipofill/v1/planning_service.grpc.pb.h"
#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

/// A square of 40 mm as OBJ that is 2 mm higher in its middle, and `height` anywhere.
std::string make_hill(double height) {
  constexpr int kSides = 40;
  std::string text;
  for (int j = 0; j <= kSides; ++j) {
    for (int i = 0; i <= kSides; ++i) {
      const double away = std::hypot(i - 20.0, j - 20.0) / 14.0;
      const double hill = away < 1.0 ? std::cos(0.5 * 3.14159265358979 * away) : 0.0;
      absl::StrAppend(&text, "v ", i, " ", j, " ", height + 2.0 * hill * hill, "\n");
    }
  }
  for (int j = 0; j < kSides; ++j) {
    for (int i = 0; i < kSides; ++i) {
      const int a = j * (kSides + 1) + i + 1;
      absl::StrAppend(&text, "f ", a, " ", a + 1, " ", a + kSides + 2, " ", a + kSides + 1, "\n");
    }
  }
  return text;
}

class ProposalTest : public RunTest {
 protected:
  ProposalTest() : planning_(v1::PlanningService::NewStub(channel_)) {}

  v1::ProposePlanRequest make_request(double height = 0.0) {
    v1::ProposePlanRequest request;
    request.set_parent("patients/anna");
    *request.mutable_spec()->mutable_plan() = square_plan(model_.name(), 10.0);
    v1::Scan target;
    const grpc::Status sent = upload("patients/anna", v1::OBJ, make_hill(height), target);
    EXPECT_TRUE(sent.ok()) << sent.error_message();
    request.mutable_spec()->set_target_scan(target.name());
    return request;
  }
  grpc::Status start(const v1::ProposePlanRequest& request, v1::Operation& operation) {
    return call(*planning_, &v1::PlanningService::Stub::ProposePlan, request, operation);
  }
  v1::Operation finish(const v1::ProposePlanRequest& request) {
    v1::Operation operation;
    const grpc::Status started = start(request, operation);
    EXPECT_TRUE(started.ok()) << started.error_message();
    return started.ok() ? await(operation) : operation;
  }
  v1::Proposal propose(const v1::ProposePlanRequest& request) {
    const v1::Operation operation = finish(request);
    v1::Proposal proposal;
    EXPECT_TRUE(operation.response().UnpackTo(&proposal)) << operation.error().message();
    return proposal;
  }

  std::unique_ptr<v1::PlanningService::Stub> planning_;
};

TEST_F(ProposalTest, ItsPlanRunsToTheShapeItTellsOf) {
  const v1::Proposal proposal = propose(make_request());
  ASSERT_EQ(proposal.volumes_size(), 1);
  EXPECT_EQ(proposal.volumes(0).zone(), "middle");
  EXPECT_GT(proposal.volumes(0).volume_ml(), 0.3);
  EXPECT_LT(proposal.reached().skin_to_target().rms_mm(), 0.5 * proposal.before().skin_to_target().rms_mm());
  EXPECT_GT(proposal.solves(), 2u);
  ASSERT_EQ(proposal.plan().injections_size(), 1);
  EXPECT_EQ(proposal.plan().injections(0).volume_ml(), proposal.volumes(0).volume_ml());
  ASSERT_LT(proposal.proposed_point(), static_cast<uint32_t>(proposal.curve_size()));
  EXPECT_EQ(proposal.curve(static_cast<int>(proposal.proposed_point())).total_ml(), proposal.total_ml());
  v1::Simulation simulation;
  const grpc::Status created = create_simulation(proposal.plan(), "proposed", true, simulation);
  ASSERT_TRUE(created.ok()) << created.error_message();
  simulation = await_end("simulations/proposed");
  EXPECT_EQ(simulation.state(), v1::Simulation::SETTLED) << simulation.reason();
  EXPECT_EQ(simulation.summary().state_hash(), proposal.state_hash());
}

TEST_F(ProposalTest, AnEqualRequestHasTheSameProposalAlsoAfterARestart) {
  v1::ProposePlanRequest request = make_request();
  request.set_request_id("once");
  v1::Proposal first = propose(request);
  restart();
  planning_ = v1::PlanningService::NewStub(channel_);
  v1::Proposal again = propose(request);
  first.clear_wall_s();
  again.clear_wall_s();
  EXPECT_EQ(first.SerializeAsString(), again.SerializeAsString());
}

TEST_F(ProposalTest, ProposesZonesAndHoldsThemToBounds) {
  v1::ProposePlanRequest request = make_request();
  request.mutable_spec()->mutable_plan()->clear_films();
  request.mutable_spec()->mutable_plan()->clear_injections();
  request.mutable_spec()->mutable_zones()->add_below_layers("skin");
  request.mutable_spec()->mutable_zones()->set_min_deficit_mm(0.5);
  request.mutable_spec()->mutable_bounds()->set_max_total_ml(0.2);
  const v1::Proposal proposal = propose(request);
  ASSERT_GE(proposal.volumes_size(), 1);
  EXPECT_TRUE(proposal.volumes(0).proposed_zone());
  EXPECT_LE(proposal.total_ml(), 0.2);
  EXPECT_EQ(proposal.volumes(0).bound(), "max_total_ml");
  ASSERT_GE(proposal.remainders_size(), 1);
  EXPECT_EQ(proposal.remainders(0).cause(), v1::Remainder::BOUND);
  v1::Simulation simulation;
  const grpc::Status created = create_simulation(proposal.plan(), "zones", true, simulation);
  ASSERT_TRUE(created.ok()) << created.error_message();
  EXPECT_EQ(await_end("simulations/zones").summary().state_hash(), proposal.state_hash());
}

TEST_F(ProposalTest, HoldsInMostCasesOfTissue) {
  v1::ProposePlanRequest request = make_request();
  const v1::Proposal free = propose(request);
  request.mutable_spec()->mutable_spread()->set_pressure_band_pa(free.max_pressure_pa());
  request.mutable_spec()->mutable_spread()->set_members(40);
  const v1::Proposal held = propose(request);
  ASSERT_TRUE(held.has_robustness());
  EXPECT_GE(held.robustness().members_below(), 38u);
  EXPECT_LT(held.robustness().nominal_members_below(), 38u);
  EXPECT_LT(held.total_ml(), free.total_ml());
  EXPECT_EQ(held.robustness().nominal_total_ml(), free.total_ml());
}

TEST_F(ProposalTest, RefusesWithFieldsAndFigures) {
  v1::ProposePlanRequest request = make_request();
  request.mutable_spec()->mutable_bounds()->set_max_total_ml(-1.0);
  request.mutable_spec()->mutable_spread()->set_share(2.0);
  v1::Operation operation;
  EXPECT_THAT(violations_of(start(request, operation)),
              ::testing::UnorderedElementsAre(::testing::Key("spec.bounds.max_total_ml"),
                                              ::testing::Key("spec.spread.pressure_band_pa"),
                                              ::testing::Key("spec.spread.share")));
  operation = finish(make_request(-5.0));
  EXPECT_EQ(operation.error().code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(operation.error().message(), HasSubstr("nothing is missing: the target lies everywhere below the skin"));
  request = make_request();
  request.set_validate_only(true);
  ASSERT_TRUE(start(request, operation).ok());
  EXPECT_TRUE(operation.done());
  EXPECT_EQ(operation.name(), "");
}

TEST_F(ProposalTest, MakesAListThatIsThePlan) {
  const v1::Proposal proposal = propose(make_request());
  v1::PlanDeliveryRequest request;
  *request.mutable_plan() = proposal.plan();
  request.set_compare(true);
  v1::Delivery delivery;
  const grpc::Status status = call(*planning_, &v1::PlanningService::Stub::PlanDelivery, request, delivery);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(delivery.entries_size(), 1);
  EXPECT_EQ(delivery.entries(0).passes(), static_cast<uint32_t>(delivery.passes_size()));
  double total = 0.0;
  for (const v1::CannulaPass& pass : delivery.passes()) {
    EXPECT_LE(pass.volume_ml(), 0.1 + 1e-12);
    EXPECT_GE(pass.path_mm_size(), 2);
    total += pass.volume_ml();
  }
  EXPECT_NEAR(total, proposal.total_ml(), 1e-9);
  EXPECT_LT(delivery.difference().max_mm(), 0.003) << "fat that flows comes to the same shape";
  v1::CheckPlanRequest check;
  *check.mutable_spec() = delivery.plan_as_given();
  v1::CheckPlanResponse checked;
  ASSERT_TRUE(call(*simulations_, &v1::SimulationService::Stub::CheckPlan, check, checked).ok());
  EXPECT_EQ(checked.violations_size(), 0) << checked.ShortDebugString();
}

}  // namespace
}  // namespace lipofill::testing
