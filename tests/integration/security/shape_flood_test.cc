// FindShape asked for thousands of times a second, and by a client that does not read: each call
// has a clear answer, and others keep their share.

#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>

#include "lipofill/v1/simulation_service.grpc.pb.h"
#include "tests/integration/security/raw_http2.h"
#include "tests/integration/security/secure_fixture.h"
#include "tests/integration/service/footprint.h"

namespace lipofill::testing {
namespace {

using grpc::StatusCode;

/// How calls that were made at once end.
class Flood {
 public:
  explicit Flood(v1::SimulationService::Stub& stub) : stub_(stub) {}

  void ask(const Caller& caller, const v1::FindShapeRequest& request) {
    calls_.emplace_back(*this, caller.context(), request).begin(stub_);
  }
  /// Waits for all that were asked.
  std::map<StatusCode, int> await() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::minutes(3), [this] { return n_ended_ == calls_.size(); });
    EXPECT_EQ(n_ended_, calls_.size()) << "each call has an answer";
    return codes_;
  }

 private:
  class Call : public grpc::ClientReadReactor<v1::FindShapeResponse> {
   public:
    Call(Flood& flood, std::unique_ptr<grpc::ClientContext> context, v1::FindShapeRequest request)
        : flood_(flood), context_(std::move(context)), request_(std::move(request)) {}
    void begin(v1::SimulationService::Stub& stub) {
      stub.async()->FindShape(context_.get(), &request_, this);
      StartRead(&response_);
      StartCall();
    }
    void OnReadDone(bool ok) override {
      if (ok) StartRead(&response_);
    }
    void OnDone(const grpc::Status& status) override { flood_.end(status.error_code()); }

   private:
    Flood& flood_;
    const std::unique_ptr<grpc::ClientContext> context_;
    const v1::FindShapeRequest request_;
    v1::FindShapeResponse response_;
  };
  void end(StatusCode code) {
    const std::lock_guard lock(mutex_);
    ++codes_[code];
    ++n_ended_;
    changed_.notify_all();
  }

  v1::SimulationService::Stub& stub_;
  std::deque<Call> calls_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<StatusCode, int> codes_;
  size_t n_ended_ = 0;
};

class ShapeFloodTest : public SecureTest {
 protected:
  ShapeFloodTest() : wards_(caller("ward", "planner"), "ward"), clinics_(caller("clinic", "planner"), "clinic") {}

  int port() const { return std::stoi(daemon_->address().substr(daemon_->address().find(':') + 1)); }
  v1::FindShapeRequest request(int number, const std::string& drag) const {
    v1::FindShapeRequest request;
    request.set_simulation(wards_.simulation);
    request.set_drag(drag);
    v1::InjectionVolume& volume = *request.add_injections();
    volume.set_volume_ml(0.02 + 1e-6 * number);
    return request;
  }
  void start_the_clinics() {
    const Answer started =
        caller("clinic", "planner")
            .call_json("SimulationService/StartSimulation", R"({"name":")" + clinics_.simulation + "\"}");
    ASSERT_TRUE(started.status.ok()) << started.status.error_message();
  }
  uint64_t steps_of_the_clinics() {
    const Answer answer =
        caller("clinic", "viewer")
            .call_json("SimulationService/GetSimulation", R"({"name":")" + clinics_.simulation + "\"}");
    v1::Simulation simulation;
    EXPECT_TRUE(answer.status.ok() && simulation.ParseFromString(answer.messages.at(0)))
        << answer.status.error_message();
    return simulation.summary().steps();
  }
  /// Of another tenant than the flood's.
  bool a_simulation_can_be_made() {
    v1::CreateSimulationRequest request;
    const Answer answer =
        caller("clinic", "viewer")
            .call_json("SimulationService/GetSimulation", R"({"name":")" + clinics_.simulation + "\"}");
    v1::Simulation simulation;
    if (!answer.status.ok() || !simulation.ParseFromString(answer.messages.at(0))) return false;
    *request.mutable_spec() = simulation.spec();
    const Answer made = caller("clinic", "planner").call("SimulationService/CreateSimulation", request);
    EXPECT_TRUE(made.status.ok()) << made.status.error_message();
    return made.status.ok();
  }

  const Possessions wards_;
  const Possessions clinics_;
};

TEST_F(ShapeFloodTest, TenThousandOfADragAreEachAnsweredAndOthersGoOn) {
  start_the_clinics();
  const auto stub = v1::SimulationService::NewStub(channel_);
  const uint64_t before = steps_of_the_clinics();
  Flood flood(*stub);
  const Caller viewer = caller("ward", "viewer");
  constexpr int kCalls = 10'000;
  for (int k = 0; k < kCalls; ++k) flood.ask(viewer, request(k, "d"));
  EXPECT_TRUE(a_simulation_can_be_made());
  std::map<StatusCode, int> ends = flood.await();
  EXPECT_GT(ends[StatusCode::OK], 0);
  EXPECT_EQ(ends[StatusCode::OK] + ends[StatusCode::ABORTED] + ends[StatusCode::RESOURCE_EXHAUSTED], kCalls);
  EXPECT_GT(steps_of_the_clinics(), before + 100);
}

TEST_F(ShapeFloodTest, WithoutADragTheyTakeNobodysRoom) {
  const auto stub = v1::SimulationService::NewStub(channel_);
  Flood flood(*stub);
  const Caller viewer = caller("ward", "viewer");
  constexpr int kCalls = 1'000;
  for (int k = 0; k < kCalls; ++k) {
    flood.ask(viewer, request(k, ""));
    if (k % 100 == 0) EXPECT_TRUE(a_simulation_can_be_made()) << k;
  }
  std::map<StatusCode, int> ends = flood.await();
  EXPECT_GT(ends[StatusCode::OK], 0);
  EXPECT_EQ(ends[StatusCode::OK] + ends[StatusCode::RESOURCE_EXHAUSTED], kCalls);
}

TEST_F(ShapeFloodTest, OneThatDoesNotReadHoldsNobodyUp) {
  start_the_clinics();
  const RawHttp2::Headers who = {{"authorization", "Bearer " + token(claims("ward", "viewer"))}};
  const double before_mb = read_footprint(daemon_->pid()).resident_mb;
  std::vector<std::unique_ptr<RawHttp2>> deaf;
  for (int client = 0; client < 4; ++client) {
    deaf.push_back(std::make_unique<RawHttp2>(port(), 0));
    for (int k = 0; k < 200; ++k) {
      const std::string message = request(k, k % 2 == 0 ? "d" : "").SerializeAsString();
      const auto stream = static_cast<uint32_t>(2 * k + 1);
      ASSERT_TRUE(
          deaf.back()->send(RawHttp2::whole_call(stream, "/lipofill.v1.SimulationService/FindShape", message, who)));
    }
  }
  const uint64_t before = steps_of_the_clinics();
  while (steps_of_the_clinics() < before + 100) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(a_simulation_can_be_made());
  // The ward's own, who reads, is answered too.
  const Answer read = caller("ward", "planner").call("SimulationService/FindShape", request(1, "mine"));
  EXPECT_TRUE(read.status.ok()) << read.status.error_message();
  EXPECT_LT(read_footprint(daemon_->pid()).resident_mb, before_mb + 200.0);
}

}  // namespace
}  // namespace lipofill::testing
