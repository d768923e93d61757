// A daemon that finds its database missing, empty, older, or another's removes nothing.

#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Patients = v1::PatientService::Stub;

class MissingDataTest : public RunTest {
 protected:
  MissingDataTest() {
    EXPECT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(), scan_).ok());
    create(1e5, "x", false);
    v1::CreateCheckpointRequest request;
    request.set_parent("simulations/x");
    request.set_checkpoint_id("mine");
    v1::Checkpoint checkpoint;
    EXPECT_TRUE(call(*simulations_, &v1::SimulationService::Stub::CreateCheckpoint, request, checkpoint).ok());
    EXPECT_EQ(daemon_->terminate(), 0);
  }
  fs::path data() const { return directory_.path() / "data"; }
  fs::path database() const { return data() / "lipofill.sqlite"; }
  /// Files of scans and checkpoints in their places.
  int n_kept_files() const {
    int n = 0;
    for (const char* part : {"scans", "checkpoints"}) {
      for (const auto& entry : fs::recursive_directory_iterator(data() / part)) n += entry.is_regular_file() ? 1 : 0;
    }
    return n;
  }
  void expect_refused(const std::string& why) {
    std::string output;
    EXPECT_EQ(run_daemon_to_end({"--listen", "127.0.0.1:0", "--data", data().string()}, output), 1) << output;
    EXPECT_THAT(output, HasSubstr(why));
    EXPECT_EQ(n_kept_files(), 2) << "nothing is removed";
  }
  grpc::Status download(const std::string& scan) {
    Context context;
    v1::DownloadScanMeshRequest request;
    request.set_name(scan);
    auto stream = patients_->DownloadScanMesh(&context, request);
    v1::MeshSlice slice;
    while (stream->Read(&slice)) {
    }
    return stream->Finish();
  }

  v1::Scan scan_;
};

TEST_F(MissingDataTest, AStartWithoutTheDatabaseIsRefusedAndNothingIsLost) {
  const std::string elsewhere = directory_.file("elsewhere");
  fs::rename(database(), elsewhere);
  expect_refused("lipofill.sqlite is missing, but there is");
  std::ofstream(database()).close();
  expect_refused("lipofill.sqlite is empty, but there is");
  fs::remove(data() / "store-id");  // as in a directory of an earlier version
  expect_refused("lipofill.sqlite is empty, but there is");
  fs::rename(elsewhere, database());
  connect();
  EXPECT_TRUE(download(scan_.name()).ok());
  EXPECT_EQ(get_simulation("simulations/x").state(), v1::Simulation::READY);
}

TEST_F(MissingDataTest, TheDatabaseOfAnotherDirectoryIsRefused) {
  DaemonProcess other(directory_.file("other"));
  EXPECT_EQ(other.terminate(), 0);
  fs::copy_file(directory_.path() / "other" / "lipofill.sqlite", database(), fs::copy_options::overwrite_existing);
  expect_refused("is the database of another data directory");
}

TEST_F(MissingDataTest, FilesThatAnOlderDatabaseDoesNotKnowAreSetAside) {
  const std::string older = directory_.file("older"), newer = directory_.file("newer");
  fs::copy_file(database(), older);
  connect();
  const std::string bytes = sheet_obj(20);
  v1::Scan later;
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, bytes, later).ok());
  EXPECT_EQ(daemon_->terminate(), 0);
  fs::rename(database(), newer);
  fs::copy_file(older, database());
  connect();
  EXPECT_THAT(daemon_->log(), HasSubstr("the database is older than its directory"));
  EXPECT_THAT(daemon_->log(), HasSubstr("1 files of which the database knows nothing were set aside"));
  EXPECT_TRUE(download(scan_.name()).ok()) << "what it knows is there";
  EXPECT_EQ(download(later.name()).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(daemon_->terminate(), 0);

  // The newer one comes back, and the files with it.
  fs::rename(newer, database());
  int n = 0;
  for (const auto& entry : fs::directory_iterator(data() / "set-aside")) {
    fs::copy(entry.path(), data(), fs::copy_options::recursive | fs::copy_options::skip_existing);
    ++n;
  }
  EXPECT_EQ(n, 1);
  connect();
  EXPECT_TRUE(download(later.name()).ok());
}

TEST_F(MissingDataTest, WhatWasDeletedIsGoneForGoodAlsoWhenTheDaemonDiesOverIt) {
  connect();
  v1::DeletePatientRequest request;
  request.set_name("patients/anna");
  request.set_force(true);
  google::protobuf::Empty nothing;
  ASSERT_TRUE(stop("simulations/x").ok());
  ASSERT_TRUE(call(*patients_, &Patients::DeletePatient, request, nothing).ok());
  restart_hard();
  EXPECT_FALSE(fs::exists(data() / "scans" / "anna"));
  EXPECT_FALSE(fs::exists(data() / "set-aside")) << "what a user deleted is kept nowhere";
}

}  // namespace
}  // namespace lipofill::testing
