// SIGTERM: what health, callers, viewers and the service manager see, in which order, and that it
// ends.

#include <cstdlib>
#include <regex>

#include "grpc/health/v1/health.grpc.pb.h"
#include "tests/integration/service/service_fixture.h"
#include "tests/unit/server/ops/notify_socket.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;
using Health = grpc::health::v1::Health;
using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;

/// A client that waits for nothing does not read from its connections either: what is stalled here
/// is frozen.
[[maybe_unused]] const bool kNeverPolls = ::setenv("GRPC_CLIENT_CHANNEL_BACKUP_POLL_INTERVAL_MS", "0", 1) == 0;

/// Systemd's place, taken before the daemon starts.
class ServiceManagerStandIn {
 protected:
  ServiceManagerStandIn() : socket_(place_.file("notify")) {
    ::setenv("NOTIFY_SOCKET", socket_.name().c_str(), 1);
    ::setenv("WATCHDOG_USEC", "400000", 1);
  }
  ~ServiceManagerStandIn() {
    ::unsetenv("NOTIFY_SOCKET");
    ::unsetenv("WATCHDOG_USEC");
  }
  /// The next message that is no sign of life.
  std::string receive() {
    std::string message = socket_.receive();
    while (message == "WATCHDOG=1") message = socket_.receive();
    return message;
  }

  TemporaryDirectory place_;
  NotifySocket socket_;
};

class DrainTest : protected ServiceManagerStandIn, public ServiceTest {
 protected:
  DrainTest() : ServiceTest({"--drain-delay-s", "1", "--drain-timeout-s", "9"}) {
    create_patient();
    model_ = build_square();
  }

  /// One that runs until it is stopped.
  void start_simulation(const std::string& id) {
    v1::Simulation simulation;
    const grpc::Status status = create_simulation(square_plan(model_.name(), 1e6), id, true, simulation);
    ASSERT_TRUE(status.ok()) << status.error_message();
  }
  /// Health turns first, refusals follow at once.
  void await_refusal() {
    v1::Patient patient;
    grpc::Status refused;
    for (int i = 0; i < 20 && refused.ok(); ++i) {
      refused = call(*patients_, &v1::PatientService::Stub::CreatePatient, v1::CreatePatientRequest(), patient);
    }
    EXPECT_EQ(refused.error_code(), grpc::StatusCode::UNAVAILABLE);
  }
  /// All there are but for those that only look at, change or end what is there.
  static std::vector<std::string> methods_that_begin_something() {
    const std::regex others(
        R"((Get|List|Check|Wait|Download|Export|Evaluate|Acknowledge|Update|Pause|Stop|Cancel|Delete).*)");
    std::vector<std::string> methods;
    for (const google::protobuf::FileDescriptor* file :
         {v1::WatchRequest::descriptor()->file(), v1::GetOperationRequest::descriptor()->file(),
          v1::GetPatientRequest::descriptor()->file(), v1::GetSimulationRequest::descriptor()->file()}) {
      const auto* service = file->service(0);
      for (int i = 0; i < service->method_count(); ++i) {
        if (std::regex_match(service->method(i)->name(), others)) continue;
        methods.push_back("/" + service->full_name() + "/" + service->method(i)->name());
      }
    }
    EXPECT_GE(methods.size(), 9u);
    return methods;
  }
  static std::string reason_of(const grpc::Status& status, double* retry_delay_s = nullptr) {
    google::rpc::Status message;
    EXPECT_TRUE(message.ParseFromString(status.error_details()));
    std::string reason;
    for (const auto& detail : message.details()) {
      google::rpc::ErrorInfo info;
      google::rpc::RetryInfo retry;
      if (detail.UnpackTo(&info)) reason = info.reason();
      if (detail.UnpackTo(&retry) && retry_delay_s != nullptr) {
        *retry_delay_s = static_cast<double>(retry.retry_delay().seconds());
      }
    }
    return reason;
  }

  v1::Model model_;
};

/// Health as a load balancer follows it.
class HealthWatch {
 public:
  explicit HealthWatch(const std::shared_ptr<grpc::Channel>& channel)
      : stub_(Health::NewStub(channel)), stream_(stub_->Watch(&context_, HealthCheckRequest())) {}
  ~HealthWatch() {
    context_.TryCancel();
    stream_->Finish();
  }
  HealthCheckResponse::ServingStatus next() {
    HealthCheckResponse response;
    return stream_->Read(&response) ? response.status() : HealthCheckResponse::UNKNOWN;
  }

 private:
  std::unique_ptr<Health::Stub> stub_;
  Context context_;
  std::unique_ptr<grpc::ClientReader<HealthCheckResponse>> stream_;
};

TEST_F(DrainTest, RefusesWhatIsNewTellsViewersAndEndsWellWithinItsTime) {
  start_simulation("x");
  HealthWatch health(channel_);
  EXPECT_EQ(health.next(), HealthCheckResponse::SERVING);
  v1::WatchRequest request;
  request.set_simulation("simulations/x");
  Watcher viewer(*channel_, request);
  SeenFrame frame;
  ASSERT_TRUE(viewer.next(frame));

  daemon_->signal(SIGTERM);
  EXPECT_EQ(health.next(), HealthCheckResponse::NOT_SERVING) << "first of all";

  await_refusal();
  for (const std::string& method : methods_that_begin_something()) {
    double retry_delay_s = 0.0;
    const grpc::Status refused = call_raw(method, "");
    EXPECT_EQ(refused.error_code(), grpc::StatusCode::UNAVAILABLE) << method;
    EXPECT_EQ(reason_of(refused, &retry_delay_s), "DRAINING") << method << ": " << refused.error_message();
    EXPECT_GT(retry_delay_s, 0.0) << method;
  }
  Watcher late(*channel_, request);
  EXPECT_EQ(late.drain(), 0);
  EXPECT_EQ(reason_of(late.finish()), "DRAINING");
  EXPECT_EQ(get_simulation("simulations/x").state(), v1::Simulation::RUNNING) << "who looks is answered";

  viewer.drain();
  const grpc::Status end = viewer.finish();
  EXPECT_EQ(end.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(reason_of(end), "DRAINING") << end.error_message();
  EXPECT_EQ(daemon_->wait(), 0);
  connect();
  EXPECT_GT(get_simulation("simulations/x").summary().steps(), 0u) << "what was reached is kept";
}

TEST_F(DrainTest, IsNotHeldUpByWhoDoesNotReadOrSend) {
  start_simulation("x");
  v1::WatchRequest request;
  request.set_simulation("simulations/x");
  request.set_delivery(v1::WatchRequest::EVERY);
  request.add_meshes("tissue");
  Watcher stalled(*channel_, request);
  SeenFrame frame;
  ASSERT_TRUE(stalled.next(frame));
  Context context;
  v1::Scan scan;
  const auto upload = patients_->UploadScan(&context, &scan);
  daemon_->signal(SIGTERM);
  EXPECT_EQ(daemon_->wait(), 0) << daemon_->log();
  stalled.cancel();
  context.TryCancel();
}

TEST_F(DrainTest, TellsTheServiceManager) {
  EXPECT_THAT(receive(), HasSubstr("READY=1\nSTATUS=serving 127.0.0.1:0"));
  EXPECT_EQ(socket_.receive(), "WATCHDOG=1");
  EXPECT_EQ(socket_.receive(), "WATCHDOG=1");
  daemon_->signal(SIGTERM);
  EXPECT_EQ(receive(), "STOPPING=1\nSTATUS=draining");
  EXPECT_EQ(daemon_->wait(), 0);
}

}  // namespace
}  // namespace lipofill::testing
