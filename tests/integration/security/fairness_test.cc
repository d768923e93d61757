// Tenants on one daemon: none gets more of it, or gets it earlier, because it asks for more.

#include <algorithm>
#include <thread>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "tests/integration/security/secure_fixture.h"

namespace lipofill::testing {
namespace {

/// A planner with a patient and a model, whose simulations run for very long.
class Planner {
 public:
  Planner(const Caller& caller, std::string tenant)
      : caller_(caller), tenant_(std::move(tenant)), own_(caller_, tenant_) {}

  /// Starts a simulation.
  Answer run(const std::string& id) const {
    v1::CreateSimulationRequest request;
    request.set_simulation_id(tenant_ + "-" + id);
    *request.mutable_spec() = simulation(own_.simulation).spec();
    request.set_start(true);
    return caller_.call("SimulationService/CreateSimulation", request);
  }
  v1::Simulation look(const std::string& id) const { return simulation("simulations/" + tenant_ + "-" + id); }
  Answer stop(const std::string& id) const {
    return caller_.call_json("SimulationService/StopSimulation",
                             R"({"name":"simulations/)" + tenant_ + "-" + id + "\"}");
  }
  double steps(const std::vector<std::string>& ids) const {
    double sum = 0.0;
    for (const std::string& id : ids) sum += static_cast<double>(look(id).summary().steps());
    return sum;
  }

 private:
  v1::Simulation simulation(const std::string& name) const {
    v1::GetSimulationRequest request;
    request.set_name(name);
    const Answer answer = caller_.call("SimulationService/GetSimulation", request);
    v1::Simulation simulation;
    EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
    EXPECT_TRUE(answer.messages.size() == 1 && simulation.ParseFromString(answer.messages[0]));
    return simulation;
  }

  const Caller caller_;
  const std::string tenant_;
  const Possessions own_;
};

bool has_retry_info(const Answer& answer) {
  google::rpc::Status wire;
  wire.ParseFromString(answer.status.error_details());
  return std::any_of(wire.details().begin(), wire.details().end(),
                     [](const auto& detail) { return detail.template Is<google::rpc::RetryInfo>(); });
}

class TenantQueueTest : public SecureTest {
 protected:
  TenantQueueTest() : SecureTest({"--max-running", "1"}) {}
};

TEST_F(TenantQueueTest, ATenantDoesNotWaitBehindAllThatAnotherQueued) {
  const Planner ward(caller("ward", "planner"), "ward");
  const Planner clinic(caller("clinic", "planner"), "clinic");
  for (const char* id : {"1", "2", "3", "4"}) ASSERT_TRUE(ward.run(id).status.ok());
  EXPECT_EQ(ward.look("1").state(), v1::Simulation::RUNNING);
  EXPECT_EQ(ward.look("2").queue_position(), 1u);
  ASSERT_TRUE(clinic.run("1").status.ok());
  EXPECT_EQ(clinic.look("1").state(), v1::Simulation::QUEUED);
  EXPECT_EQ(clinic.look("1").queue_position(), 1u);
  EXPECT_EQ(ward.look("2").queue_position(), 2u);
  EXPECT_EQ(ward.look("4").queue_position(), 4u);
  ASSERT_TRUE(ward.stop("1").status.ok());
  // The one who leaves is noticed with its next turn.
  while (clinic.look("1").state() == v1::Simulation::QUEUED) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(clinic.look("1").state(), v1::Simulation::RUNNING);
  EXPECT_EQ(ward.look("2").queue_position(), 1u);
  ASSERT_TRUE(clinic.stop("1").status.ok());
  while (ward.look("2").state() == v1::Simulation::QUEUED) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(ward.look("3").queue_position(), 1u);
}

class TenantShareTest : public SecureTest {
 protected:
  TenantShareTest() : SecureTest({"--workers", "1"}) {}
};

TEST_F(TenantShareTest, TenantsGetEqualTimeHoweverManySimulationsTheyRun) {
  const Planner ward(caller("ward", "planner"), "ward");
  const Planner clinic(caller("clinic", "planner"), "clinic");
  const std::vector<std::string> four = {"1", "2", "3", "4"};
  for (const std::string& id : four) ASSERT_TRUE(ward.run(id).status.ok());
  ASSERT_TRUE(clinic.run("1").status.ok());
  // The first steps cost more than the others: a factor each.
  while (clinic.steps({"1"}) < 200) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const double clinic_before = clinic.steps({"1"});
  const double ward_before = ward.steps(four);
  while (clinic.steps({"1"}) < clinic_before + 2000) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const double clinic_after = clinic.steps({"1"});
  const double ward_after = ward.steps(four);
  // Simulation by simulation the ward would have four times as many.
  const double ratio = (ward_after - ward_before) / (clinic_after - clinic_before);
  EXPECT_GT(ratio, 0.5);
  EXPECT_LT(ratio, 2.0);
}

class TenantBoundTest : public SecureTest {
 protected:
  TenantBoundTest() : SecureTest({"--max-simulations-per-tenant", "2"}) {}
};

TEST_F(TenantBoundTest, CountsEachTenantsOwn) {
  const Planner ward(caller("ward", "planner"), "ward");  // with a simulation that is READY
  const Planner clinic(caller("clinic", "planner"), "clinic");
  ASSERT_TRUE(ward.run("1").status.ok());
  const Answer refused = ward.run("2");
  EXPECT_EQ(refused.code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(refused.reason(), "TOO_MANY_SIMULATIONS_OF_TENANT");
  EXPECT_TRUE(has_retry_info(refused));
  EXPECT_TRUE(clinic.run("1").status.ok());
  EXPECT_EQ(clinic.run("2").reason(), "TOO_MANY_SIMULATIONS_OF_TENANT");
  // One that has ended makes room for its own tenant's.
  ASSERT_TRUE(ward.stop("1").status.ok());
  EXPECT_TRUE(ward.run("2").status.ok());
  EXPECT_EQ(clinic.run("2").code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
}

}  // namespace
}  // namespace lipofill::testing
