// A data directory on a small file system that runs full: things can be deleted, and a start waits
// for room.

#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

namespace fs = std::filesystem;
using grpc::StatusCode;
using ::testing::HasSubstr;
using Simulations = v1::SimulationService::Stub;

class FullDiskTest : public RunTest {
 protected:
  FullDiskTest() : RunTest({"--space-reserve-mb", "4"}) {}

  /// Moves the data to a file system of its own. Needs the right to mount one.
  void SetUp() override {
    EXPECT_EQ(daemon_->terminate(), 0);
    const std::string elsewhere = directory_.file("elsewhere");
    fs::rename(data(), elsewhere);
    fs::create_directory(data());
    if (::unshare(CLONE_NEWNS) != 0 || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        ::mount("none", data().c_str(), "tmpfs", 0, "size=32m,mode=700") != 0) {
      GTEST_SKIP() << "no file system can be mounted here: " << std::strerror(errno);
    }
    is_mounted_ = true;
    fs::remove(elsewhere + "/reserve");
    fs::copy(elsewhere, data(), fs::copy_options::recursive);
    connect();
  }
  void TearDown() override {
    if (daemon_ != nullptr && daemon_->running()) daemon_->kill_hard();
    if (is_mounted_) ::umount2(data().c_str(), MNT_DETACH);
  }
  fs::path data() const { return directory_.path() / "data"; }

  /// Takes all room that there is.
  void fill_disk() {
    std::ofstream filler(data() / "filler", std::ios::binary | std::ios::app);
    const std::string block(4096, 'x');
    while (filler.write(block.data(), 4096) && filler.flush()) {
    }
    ASSERT_EQ(fs::space(data()).available, 0u);
  }
  void empty_disk() { fs::remove(data() / "filler"); }
  grpc::Status remove(const std::string& name) {
    v1::DeleteSimulationRequest request;
    request.set_name(name);
    google::protobuf::Empty nothing;
    return call(*simulations_, &Simulations::DeleteSimulation, request, nothing);
  }
  grpc::Status make_patient(const std::string& id) {
    v1::CreatePatientRequest request;
    request.set_patient_id(id);
    request.set_display_name(std::string(60, 'n'));
    v1::Patient patient;
    return call(*patients_, &v1::PatientService::Stub::CreatePatient, request, patient);
  }
  /// Makes patients until there is no room for one more; the log of the database has some to begin
  /// with.
  void use_up_room() {
    for (int i = 0; i < 20'000; ++i) {
      const grpc::Status made = make_patient("p" + std::to_string(i));
      if (made.error_code() == StatusCode::RESOURCE_EXHAUSTED) return;
      ASSERT_TRUE(made.ok()) << made.error_message();
    }
    FAIL() << "there is always room";
  }

  bool is_mounted_ = false;
};

TEST_F(FullDiskTest, ThingsCanBeDeleted) {
  create(1e5, "running");
  await_end(create(0.3, "ended").name());
  v1::Scan scan;
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(100), scan).ok());
  fill_disk();
  use_up_room();
  EXPECT_TRUE(remove("simulations/ended").ok());
  EXPECT_TRUE(remove("simulations/running").ok());
  v1::DeleteScanRequest request;
  request.set_name(scan.name());
  google::protobuf::Empty nothing;
  const grpc::Status removed = call(*patients_, &v1::PatientService::Stub::DeleteScan, request, nothing);
  EXPECT_TRUE(removed.ok()) << removed.error_message();
  restart_hard();
  EXPECT_EQ(start("simulations/ended").error_code(), StatusCode::NOT_FOUND);
  EXPECT_EQ(start("simulations/running").error_code(), StatusCode::NOT_FOUND);
}

TEST_F(FullDiskTest, AStartWaitsForRoomSaysSoAndGoesOn) {
  create(1e5, "x");
  while (get_simulation("simulations/x").summary().steps() < 20) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  fill_disk();
  use_up_room();
  daemon_->kill_hard();
  fill_disk();
  connect();
  v1::Simulation waiting = get_simulation("simulations/x");
  ASSERT_TRUE(waiting.has_recovery()) << waiting.ShortDebugString();
  EXPECT_NE(waiting.recovery().waiting_for(), "");
  Watcher watcher(*channel_, watch_request("simulations/x", v1::WatchRequest::LATEST));
  EXPECT_EQ(watcher.drain(), 0);
  const grpc::Status watched = watcher.finish();
  EXPECT_EQ(watched.error_code(), StatusCode::UNAVAILABLE) << watched.error_message();
  EXPECT_THAT(watched.error_message(), HasSubstr("tries again in"));
  empty_disk();
  for (int i = 0; i < 6000 && waiting.has_recovery(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    waiting = get_simulation("simulations/x");
  }
  EXPECT_FALSE(waiting.has_recovery());
  EXPECT_EQ(waiting.state(), v1::Simulation::RUNNING);
  EXPECT_TRUE(pause("simulations/x").ok());
}

}  // namespace
}  // namespace lipofill::testing
