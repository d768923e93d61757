// Allocations that fail: the call or the simulation that wanted the memory is refused or fails, in
// words; the daemon goes on, and when there is memory again so does everything else.

#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "tests/integration/service/run_fixture.h"

#ifdef LIPOFILL_SCARCE_MEMORY

namespace lipofill::testing {
namespace {

using grpc::StatusCode;

/// Daemons that are started meanwhile find no memory when told.
class ScarceMemory {
 public:
  ScarceMemory() {
    ::setenv("LIPOFILL_TEST_SCARCE", file_.c_str(), 1);
    ::setenv("LD_PRELOAD", LIPOFILL_SCARCE_MEMORY, 1);
  }
  ~ScarceMemory() { started(); }
  static void started() {
    ::unsetenv("LD_PRELOAD");
    ::unsetenv("LIPOFILL_TEST_SCARCE");
  }
  /// One of so many allocations of as many bytes or more fails.
  void begin(size_t bytes, int one_of) const {
    std::ofstream(file_ + ".new") << bytes << " " << one_of;
    std::filesystem::rename(file_ + ".new", file_);
  }
  void end() const { std::filesystem::remove(file_); }

 private:
  TemporaryDirectory directory_;
  const std::string file_ = directory_.file("scarce");
};

class ScarceMemoryTest : protected ScarceMemory, public RunTest {
 protected:
  ScarceMemoryTest() {
    ScarceMemory::started();
    EXPECT_TRUE(upload("patients/anna", v1::OBJ, bytes_, scan_).ok());
    run("kept");
  }

  /// A simulation that ends by itself.
  v1::Simulation run(const std::string& id) {
    v1::Simulation simulation;
    const grpc::Status made = create_simulation(square_plan(model_.name(), 0.05), id, true, simulation);
    if (!made.ok()) return simulation;
    while (!has_ended(simulation.state())) {
      v1::GetSimulationRequest request;
      request.set_name(simulation.name());
      if (!call(*simulations_, &v1::SimulationService::Stub::GetSimulation, request, simulation).ok()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      if (!daemon_lives()) break;
    }
    return simulation;
  }
  bool daemon_lives() const {
    return ::kill(daemon_->pid(), 0) == 0 && daemon_->log().find("terminate") == std::string::npos;
  }
  template <typename Reader, typename Message>
  static grpc::Status read_all(Reader& stream, Message message) {
    while (stream.Read(&message)) {
    }
    return stream.Finish();
  }

  /// Every kind of call that takes much memory, by name; each returns how it ended.
  std::map<std::string, std::function<grpc::Status()>> calls() {
    return {
        {"upload",
         [this] {
           v1::Scan scan;
           return upload("patients/anna", v1::OBJ, bytes_, scan);
         }},
        {"build",
         [this] {
           v1::ModelSpec spec = square_spec();
           spec.set_n_xi(40);
           spec.set_n_eta(30 + static_cast<uint32_t>(built_++));
           v1::Operation operation;
           const grpc::Status status = build("patients/anna", spec, operation);
           if (!status.ok() || !operation.has_error()) return status;
           return grpc::Status(static_cast<StatusCode>(operation.error().code()), operation.error().message());
         }},
        {"run",
         [this] {
           const v1::Simulation ended = run("r" + std::to_string(built_++));
           if (ended.state() == v1::Simulation::FAILED) EXPECT_NE(ended.reason(), "");
           return grpc::Status::OK;
         }},
        {"watch",
         [this] {
           Watcher watcher(*channel_, watch_request("simulations/kept", v1::WatchRequest::LATEST));
           watcher.drain();
           return watcher.finish();
         }},
        {"scan's mesh",
         [this] {
           Context context;
           v1::DownloadScanMeshRequest request;
           request.set_name(scan_.name());
           return read_all(*patients_->DownloadScanMesh(&context, request), v1::MeshSlice());
         }},
        {"deck",
         [this] {
           Context context;
           v1::ExportTissueDeckRequest request;
           request.set_name("simulations/kept");
           return read_all(*simulations_->ExportTissueDeck(&context, request), v1::ExportTissueDeckResponse());
         }},
        {"shape",
         [this] {
           Context context;
           v1::FindShapeRequest request;
           *request.mutable_spec() = square_plan(model_.name(), 600.0);
           request.mutable_spec()->mutable_time()->Clear();
           request.mutable_spec()->mutable_time()->set_goal(v1::TimeControl::SETTLED_SHAPE);
           return read_all(*simulations_->FindShape(&context, request), v1::FindShapeResponse());
         }},
    };
  }
  /// Has each kind called some times while memory is scarce. None may end the daemon, or be
  /// answered with anything but its answer or that there is no memory.
  void call_each(int times) {
    for (const auto& [name, make] : calls()) {
      for (int k = 0; k < times; ++k) {
        const grpc::Status status = make();
        EXPECT_TRUE(status.ok() || status.error_code() == StatusCode::RESOURCE_EXHAUSTED)
            << name << ": " << status.error_code() << " " << status.error_message();
        refused_ += status.ok() ? 0 : 1;
        ASSERT_TRUE(daemon_lives()) << name << ": " << daemon_->log();
      }
    }
  }
  void expect_all_works() {
    for (const auto& [name, make] : calls()) {
      grpc::Status status = make();
      for (int k = 0; k < 100 && status.error_code() == StatusCode::RESOURCE_EXHAUSTED; ++k) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        status = make();
      }
      EXPECT_TRUE(status.ok()) << name << ": " << status.error_message();
    }
    EXPECT_EQ(run("last").state(), v1::Simulation::FINISHED);
  }

  /// The daemon's address space may grow by so much from here on.
  void limit_growth(size_t bytes) const {
    std::ifstream sizes("/proc/" + std::to_string(daemon_->pid()) + "/statm");
    rlim_t pages = 0;
    ASSERT_TRUE(sizes >> pages);
    limit_address_space(pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + bytes);
  }
  void limit_address_space(rlim_t bytes) const {
    const rlimit limit = {bytes, RLIM_INFINITY};
    ASSERT_EQ(::prlimit(daemon_->pid(), RLIMIT_AS, &limit, nullptr), 0);
  }

  const std::string bytes_ = sheet_obj(150);  // of about 1 MB
  v1::Scan scan_;
  int built_ = 0;
  int refused_ = 0;
};

TEST_F(ScarceMemoryTest, EverySecondOrThirdLargeAllocationFails) {
  for (const int one_of : {3, 2}) {
    for (const size_t bytes : {100'000, 250'000, 1'000'000}) {
      begin(bytes, one_of);
      call_each(4);
      if (HasFatalFailure()) return;
    }
  }
  end();
  EXPECT_GT(refused_, 0);
  expect_all_works();
}

// The limit is the system's own: nothing that is allocated is spared, the transport's pieces, the
// algebra's blocks and the stacks of new threads among it.
TEST_F(ScarceMemoryTest, AddressSpaceIsUsedUp) {
  const std::string large = sheet_obj(700);
  for (const size_t mebibytes : {64, 16, 0}) {
    limit_growth(mebibytes << 20);
    call_each(2);
    if (HasFatalFailure()) return;
    v1::Scan scan;
    const grpc::Status status = upload("patients/anna", v1::OBJ, large, scan);
    EXPECT_EQ(status.error_code(), StatusCode::RESOURCE_EXHAUSTED) << mebibytes << " MiB: " << status.error_message();
    ASSERT_TRUE(daemon_lives()) << daemon_->log();
  }
  limit_address_space(RLIM_INFINITY);
  expect_all_works();
}

}  // namespace
}  // namespace lipofill::testing

#endif
