// Who gets in: bounds with the time to try again, the queue of simulations and the place in it.

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

template <typename Detail>
bool has_detail(const grpc::Status& status) {
  google::rpc::Status rich;
  rich.ParseFromString(status.error_details());
  return std::any_of(rich.details().begin(), rich.details().end(),
                     [](const auto& any) { return any.template Is<Detail>(); });
}

class QueueTest : public RunTest {
 protected:
  QueueTest() : RunTest({"--max-running", "1", "--workers", "2"}) {}
};

TEST_F(QueueTest, ThosePastTheBoundAreQueuedAndRunWhenTheirTurnComes) {
  create(1e5, "a");
  create(0.1, "b");
  create(0.1, "c");
  EXPECT_EQ(get_simulation("simulations/a").state(), v1::Simulation::RUNNING);
  const v1::Simulation b = get_simulation("simulations/b");
  EXPECT_EQ(b.state(), v1::Simulation::QUEUED);
  EXPECT_EQ(b.queue_position(), 1u);
  EXPECT_EQ(get_simulation("simulations/c").queue_position(), 2u);
  v1::Simulation paused;
  ASSERT_TRUE(pause("simulations/a", &paused).ok());
  EXPECT_EQ(await_end("simulations/b").state(), v1::Simulation::FINISHED);
  EXPECT_EQ(await_end("simulations/c").state(), v1::Simulation::FINISHED);
  v1::Simulation resumed;
  ASSERT_TRUE(resume("simulations/a", &resumed).ok());
  EXPECT_EQ(resumed.state(), v1::Simulation::RUNNING);
}

TEST_F(QueueTest, AQueueOutlivesTheDaemon) {
  create(1e5, "a");
  create(0.1, "b");
  restart_hard();
  // Whichever was first then, the other waits.
  const bool a_waits = get_simulation("simulations/a").state() == v1::Simulation::QUEUED;
  if (!a_waits) {
    ASSERT_TRUE(stop("simulations/a").ok());
  }
  EXPECT_EQ(await_end("simulations/b").state(), v1::Simulation::FINISHED);
}

class SmallServiceTest : public ServiceTest {
 protected:
  SmallServiceTest()
      : ServiceTest({"--max-hexahedra", "200", "--max-film-cells", "9", "--max-upload-mb", "1",
                     "--simulation-memory-mb", "64"}) {
    create_patient();
  }
};

TEST_F(SmallServiceTest, RefusesWhatIsLargerThanItTakes) {
  v1::CreateScanRequest scan;
  scan.set_parent("patients/anna");
  scan.set_format(v1::PLY);
  scan.set_size_bytes(1'000'001);
  scan.set_sha256(std::string(64, 'a'));
  v1::Scan made;
  const grpc::Status upload = call(*patients_, &v1::PatientService::Stub::CreateScan, scan, made);
  EXPECT_THAT(violations_of(upload)["size_bytes"], HasSubstr("must be in [1, 1000000]"));

  v1::ModelSpec large = square_spec();
  large.set_n_xi(101);
  v1::Operation operation;
  const grpc::Status build = this->build("patients/anna", large, operation);
  EXPECT_EQ(build.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(violations_of(build)["spec.n_xi"], HasSubstr("at most 200"));

  v1::SimulationSpec plan = square_plan(build_square().name(), 1.0);
  v1::Simulation simulation;
  EXPECT_TRUE(create_simulation(plan, "x", false, simulation).ok());
  plan.mutable_films(0)->set_n_xi(4);
  const grpc::Status fine = create_simulation(plan, "y", false, simulation);
  EXPECT_EQ(fine.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(violations_of(fine)["spec.films"], HasSubstr("makes 12 film cells, this service takes at most 9"));
}

class CrowdedServiceTest : public RunTest {
 protected:
  CrowdedServiceTest() : RunTest({"--max-simulations", "1"}) {}
};

TEST_F(CrowdedServiceTest, SaysWhenToTryAgain) {
  create(1.0, "a", false);
  v1::Simulation simulation;
  const grpc::Status refused = create_simulation(square_plan(model_.name(), 1.0), "b", false, simulation);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(has_detail<google::rpc::RetryInfo>(refused));
  EXPECT_TRUE(has_detail<google::rpc::ErrorInfo>(refused));
}

}  // namespace
}  // namespace lipofill::testing
