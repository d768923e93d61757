// Hundreds of short simulations from several clients at once on two workers: nothing hangs, nothing
// is left behind.

#include <algorithm>
#include <cstdlib>
#include <thread>

#include "absl/strings/str_cat.h"
#include "tests/integration/service/footprint.h"
#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using Simulations = v1::SimulationService::Stub;

constexpr int kClients = 4;
constexpr int kShortRun = 480;

/// Simulations of a whole run: LIPOFILL_SESSIONS where it is set, for a soak.
int sessions_of_a_run() {
  const char* wanted = std::getenv("LIPOFILL_SESSIONS");
  return wanted == nullptr ? kShortRun : std::max(kShortRun, std::atoi(wanted));
}

class ManySessionsTest : public ServiceTest {
 protected:
  ManySessionsTest() {
    create_patient();
    model_ = build_square().name();
  }

  template <typename Request, typename Response = v1::Simulation, typename Method>
  grpc::Status act(Method method, const std::string& name) {
    Request request;
    request.set_name(name);
    Response response;
    return call(*simulations_, method, request, response);
  }

  grpc::Status remove(const std::string& name) {
    return act<v1::DeleteSimulationRequest, google::protobuf::Empty>(&Simulations::DeleteSimulation, name);
  }

  /// A life of one simulation; which one depends on its number alone.
  void live(int number) {
    const std::string id = absl::StrCat("x", number);
    const std::string name = "simulations/" + id;
    v1::Simulation simulation;
    const double end_s = number % 6 == 0 ? 0.03 : 3600.0;
    const grpc::Status created = create_simulation(square_plan(model_, end_s), id, number % 6 != 5, simulation);
    ASSERT_TRUE(created.ok()) << name << ": " << created.error_message();
    switch (number % 6) {
      case 0:
        EXPECT_EQ(await_end(name).state(), v1::Simulation::FINISHED);
        break;
      case 1:
        EXPECT_TRUE(act<v1::StopSimulationRequest>(&Simulations::StopSimulation, name).ok());
        break;
      case 2:
        EXPECT_TRUE(act<v1::PauseSimulationRequest>(&Simulations::PauseSimulation, name).ok());
        EXPECT_TRUE(act<v1::ResumeSimulationRequest>(&Simulations::ResumeSimulation, name).ok());
        break;
      case 3:
        watch_and_leave(name);
        break;
      default:
        break;  // 4: deleted while it runs, 5: never started
    }
    const grpc::Status removed = remove(name);
    EXPECT_TRUE(removed.ok()) << name << ": " << removed.error_message();
  }

  void watch_and_leave(const std::string& name) {
    v1::WatchRequest request;
    request.set_simulation(name);
    Watcher watcher(*channel_, request);
    SeenFrame frame;
    EXPECT_TRUE(watcher.next(frame)) << name;
    watcher.cancel();
    watcher.drain();
    EXPECT_EQ(watcher.finish().error_code(), grpc::StatusCode::CANCELLED);
  }

  void live_through(int first, int last) {
    std::vector<std::thread> clients;
    for (int client = 0; client < kClients; ++client) {
      clients.emplace_back([this, first, last, client] {
        for (int number = first + client; number < last; number += kClients) live(number);
      });
    }
    for (std::thread& client : clients) client.join();
  }

  int listed() {
    v1::ListSimulationsResponse response;
    EXPECT_TRUE(call(*simulations_, &Simulations::ListSimulations, v1::ListSimulationsRequest(), response).ok());
    return response.simulations_size();
  }

  std::string model_;
};

TEST_F(ManySessionsTest, LeaveNothingBehind) {
  const int warm = kShortRun / 2;
  live_through(0, warm);
  const Footprint before = read_footprint(daemon_->pid());
  live_through(warm, sessions_of_a_run());
  const Footprint after = read_footprint(daemon_->pid());

  EXPECT_TRUE(is_serving());
  EXPECT_EQ(listed(), 0);
  ASSERT_GT(before.threads, 0);
  // gRPC takes and leaves a thread of its own as it is busy.
  EXPECT_LE(after.threads, before.threads + 4);
#ifndef __SANITIZE_ADDRESS__  // which keeps what is freed
  // A leak of a twentieth of a megabyte a simulation would show.
  EXPECT_LT(after.resident_mb, before.resident_mb + 12.0);
#endif
  EXPECT_EQ(daemon_->terminate(), 0);
}

}  // namespace
}  // namespace lipofill::testing
