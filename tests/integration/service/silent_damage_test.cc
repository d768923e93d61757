// One bit that flips in anything that is kept is noticed: by who reads it, by a verification, by a
// backup. It is named, and the rest serves.

#include <filesystem>
#include <fstream>

#include "server/store/sqlite_database.h"
#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

namespace fs = std::filesystem;
using grpc::StatusCode;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Patients = v1::PatientService::Stub;
using Simulations = v1::SimulationService::Stub;

constexpr int kFoundDamage = 3;

class SilentDamageTest : public RunTest {
 protected:
  SilentDamageTest() {
    EXPECT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(), scan_).ok());
    for (const auto& [id, end_s] : {std::pair{"x", 0.3}, std::pair{"y", 0.4}}) {
      await_end(create(end_s, id).name());
    }
    EXPECT_EQ(daemon_->terminate(), 0);
  }
  fs::path data() const { return directory_.path() / "data"; }
  fs::path database() const { return data() / "lipofill.sqlite"; }

  /// Flips one bit of a file within these bytes, at the first 32 of them that the file has once.
  void flip_bit(const fs::path& path, const std::string& bytes) {
    constexpr size_t kPart = 32;
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    const std::string content((std::istreambuf_iterator<char>(file)), {});
    for (size_t i = 0; i + kPart <= bytes.size(); i += 8) {
      const std::string part = bytes.substr(i, kPart);
      const size_t at = content.find(part);
      if (at == std::string::npos || content.find(part, at + 1) != std::string::npos) continue;
      file.clear();
      file.seekp(static_cast<std::streamoff>(at + kPart / 2));
      file.put(static_cast<char>(content[at + kPart / 2] ^ 1));
      return;
    }
    FAIL() << path << " has no part of these " << bytes.size() << " bytes once";
  }
  /// What the database has under a statement, as it is on the medium.
  std::string stored(const char* sql) {
    const auto database_open = server::SqliteDatabase::open(database().string());
    server::Query query(**database_open, sql);
    EXPECT_TRUE(query.next()) << sql;
    return query.text(0);
  }
  /// That a verification and a backup find this damaged, and nothing else.
  void expect_found(const std::string& name) {
    std::string output;
    EXPECT_EQ(run_daemon_to_end({"--data", data().string(), "--verify"}, output), kFoundDamage);
    EXPECT_THAT(output, HasSubstr(name));
    EXPECT_THAT(output, HasSubstr("1 are damaged"));
    const std::string backup = directory_.file("backup");
    EXPECT_EQ(run_daemon_to_end({"--data", data().string(), "--backup-to", backup}, output), kFoundDamage);
    EXPECT_THAT(output, HasSubstr(name));
    EXPECT_TRUE(fs::exists(backup + "/DAMAGED"));
    EXPECT_EQ(run_daemon_to_end({"--data", directory_.file("restored"), "--restore-from", backup}, output),
              kFoundDamage);
    EXPECT_THAT(output, HasSubstr(name)) << "a restore says so too";
  }
  void expect_damaged(const grpc::Status& status, const std::string& name) {
    EXPECT_EQ(status.error_code(), StatusCode::DATA_LOSS) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr(name));
  }
  grpc::Status watch(const std::string& name) {
    Watcher watcher(*channel_, watch_request(name, v1::WatchRequest::LATEST));
    watcher.drain();
    return watcher.finish();
  }
  grpc::Status get_series(const std::string& name) {
    v1::GetSeriesRequest request;
    request.set_name(name);
    v1::GetSeriesResponse response;
    return call(*simulations_, &Simulations::GetSeries, request, response);
  }
  grpc::Status evaluate(const std::string& name) {
    v1::EvaluateSimulationRequest request;
    request.set_name(name);
    request.set_target_scan(scan_.name());
    v1::Evaluation evaluation;
    return call(*simulations_, &Simulations::EvaluateSimulation, request, evaluation);
  }

  v1::Scan scan_;
};

TEST_F(SilentDamageTest, AWholeStoreIsWhole) {
  std::string output;
  EXPECT_EQ(run_daemon_to_end({"--data", data().string(), "--verify"}, output), 0) << output;
  EXPECT_THAT(output, HasSubstr("all is what was written"));
  connect();
  EXPECT_EQ(run_daemon_to_end({"--data", data().string(), "--verify"}, output), 0) << "while it serves: " << output;
  EXPECT_TRUE(evaluate("simulations/x").ok());
}

TEST_F(SilentDamageTest, ABitOfAFrameIsNoFrameAndNoComparison) {
  flip_bit(database(), stored("SELECT frame FROM simulation_results WHERE simulation = x'78'"));
  expect_found("simulations/x");
  connect();
  expect_damaged(watch("simulations/x"), "simulations/x");
  expect_damaged(evaluate("simulations/x"), "simulations/x");
  EXPECT_EQ(get_simulation("simulations/x").state(), v1::Simulation::FINISHED) << "the rest serves";
  EXPECT_TRUE(get_series("simulations/x").ok());
  v1::DeleteSimulationRequest request;
  request.set_name("simulations/x");
  google::protobuf::Empty nothing;
  EXPECT_TRUE(call(*simulations_, &Simulations::DeleteSimulation, request, nothing).ok()) << "it can go";
  std::string output;
  EXPECT_EQ(run_daemon_to_end({"--data", data().string(), "--verify"}, output), 0) << output;
}

TEST_F(SilentDamageTest, ABitOfTheSeriesIsNoSeries) {
  flip_bit(database(), stored("SELECT rows FROM simulation_series WHERE simulation = x'78'"));
  expect_found("simulations/x");
  connect();
  expect_damaged(get_series("simulations/x"), "simulations/x");
  EXPECT_TRUE(get_series("simulations/y").ok());
  EXPECT_TRUE(watch("simulations/x").ok());
}

TEST_F(SilentDamageTest, ABitOfAScanIsNoScanAndNoTarget) {
  const std::string id = scan_.name().substr(scan_.name().rfind('/') + 1);
  flip_bit(data() / "scans" / "anna" / id, sheet_obj().substr(100));
  expect_found(scan_.name());
  connect();
  Context context;
  v1::DownloadScanMeshRequest request;
  request.set_name(scan_.name());
  auto stream = patients_->DownloadScanMesh(&context, request);
  v1::MeshSlice slice;
  EXPECT_FALSE(stream->Read(&slice));
  expect_damaged(stream->Finish(), scan_.name());
  expect_damaged(evaluate("simulations/x"), scan_.name());
  EXPECT_TRUE(watch("simulations/x").ok());
}

TEST_F(SilentDamageTest, ABitOfAModelsPlanIsNoModelAndTheListNamesIt) {
  flip_bit(database(), stored("SELECT spec FROM models"));
  expect_found(model_.name());
  connect();
  v1::GetModelRequest request;
  request.set_name(model_.name());
  v1::Model model;
  expect_damaged(call(*patients_, &Patients::GetModel, request, model), model_.name());
  v1::ListModelsRequest list;
  list.set_parent("patients/anna");
  v1::ListModelsResponse models;
  ASSERT_TRUE(call(*patients_, &Patients::ListModels, list, models).ok());
  EXPECT_EQ(models.models_size(), 0);
  EXPECT_THAT(models.unreachable(), ElementsAre(model_.name()));
  v1::Simulation none;
  expect_damaged(create_simulation(square_plan(model_.name(), 1.0), "z", false, none), model_.name());
  EXPECT_TRUE(watch("simulations/x").ok()) << "what was computed before is there";
}

TEST_F(SilentDamageTest, ABitOfAPatientIsNamedAndTheOthersAreListed) {
  connect();
  v1::CreatePatientRequest request;
  request.set_patient_id("berta");
  request.set_display_name("the-case-of-berta-who-came-in-november");
  v1::Patient patient;
  ASSERT_TRUE(call(*patients_, &Patients::CreatePatient, request, patient).ok());
  EXPECT_EQ(daemon_->terminate(), 0);
  flip_bit(database(), "the-case-of-berta-who-came-in-november");
  expect_found("patients/berta");
  connect();
  v1::ListPatientsResponse listed;
  ASSERT_TRUE(call(*patients_, &Patients::ListPatients, v1::ListPatientsRequest(), listed).ok());
  ASSERT_EQ(listed.patients_size(), 1);
  EXPECT_EQ(listed.patients(0).name(), "patients/anna");
  EXPECT_THAT(listed.unreachable(), ElementsAre("patients/berta"));
  v1::GetPatientRequest get;
  get.set_name("patients/berta");
  expect_damaged(call(*patients_, &Patients::GetPatient, get, patient), "patients/berta");
  v1::DeletePatientRequest remove;
  remove.set_name("patients/berta");
  google::protobuf::Empty nothing;
  EXPECT_TRUE(call(*patients_, &Patients::DeletePatient, remove, nothing).ok());
}

TEST(Verify, SaysThatThereIsNoStore) {
  TemporaryDirectory directory;
  std::string output;
  EXPECT_EQ(run_daemon_to_end({"--data", directory.file("none"), "--verify"}, output), 1);
  EXPECT_THAT(output, HasSubstr("there is no store in"));
  EXPECT_EQ(run_daemon_to_end({"--help"}, output), 0);
  EXPECT_THAT(output, HasSubstr("--verify"));
}

}  // namespace
}  // namespace lipofill::testing
