#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "server/store/data_directory.h"
#include "server/store/sql_store.h"
#include "server/store/sqlite_database.h"
#include "tests/unit/server/store/store_kinds.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class StoreTest : public ::testing::TestWithParam<StoreKind> {
 protected:
  StoreTest() { reopen(); }

  void reopen() {
    store_ = nullptr;
    auto store = SqlStore::open(place_);
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
  }
  void add_patient(const std::string& id) { ASSERT_TRUE(store_->create_patient({id, "", {}, 1}, {}).ok()); }
  ScanRecord scan(const std::string& id) {
    ScanRecord record;
    record.patient = "anna";
    record.id = id;
    record.format = 2;
    record.unit = 1;
    record.size_bytes = 5'000'000'000;
    record.sha256 = "ab";
    record.create_time_us = 7;
    return record;
  }
  SimulationRecord simulation(const std::string& id) {
    return {id, "patients/anna/models/m", "show", std::string("spec\0x", 6), SimulationState::kReady, "", "", 3};
  }

  lipofill::testing::TemporaryDirectory directory_;
  const std::string place_ = make_place(GetParam(), directory_);
  std::unique_ptr<SqlStore> store_;
};

TEST_P(StoreTest, KeepsPatientsAcrossReopening) {
  ASSERT_TRUE(store_->create_patient({"anna", "a-1", {{"side", "left"}, {"arm", "b"}}, 42}, {}).ok());
  reopen();
  const auto patient = store_->get_patient("anna");
  ASSERT_TRUE(patient.ok()) << patient.status();
  EXPECT_EQ(patient->display_name, "a-1");
  EXPECT_EQ(patient->labels.at("side"), "left");
  EXPECT_EQ(patient->create_time_us, 42);
}

TEST_P(StoreTest, UpdatesAndDeletesPatients) {
  add_patient("anna");
  const auto replace = [](const std::string& name, const std::map<std::string, std::string>& labels) {
    return [=](PatientRecord present) -> absl::StatusOr<PatientRecord> {
      present.display_name = name;
      present.labels = labels;
      return present;
    };
  };
  ASSERT_TRUE(store_->update_patient("anna", replace("new", {{"k", "v"}})).ok());
  EXPECT_EQ(store_->get_patient("anna")->display_name, "new");
  ASSERT_TRUE(store_->update_patient("anna", replace("new", {})).ok());
  EXPECT_TRUE(store_->get_patient("anna")->labels.empty());
  EXPECT_TRUE(store_->delete_patient("anna", false).ok());
  EXPECT_TRUE(absl::IsNotFound(store_->get_patient("anna").status()));
  EXPECT_TRUE(absl::IsNotFound(store_->delete_patient("anna", false)));
  EXPECT_TRUE(absl::IsNotFound(store_->update_patient("anna", replace("", {})).status()));
}

TEST_P(StoreTest, LeavesAPatientWhoseChangeIsRefused) {
  add_patient("anna");
  const absl::Status refusal = absl::AbortedError("no");
  EXPECT_EQ(store_->update_patient("anna", [&](const PatientRecord&) { return refusal; }).status(), refusal);
  EXPECT_EQ(store_->delete_patient("anna", true, [&](const PatientRecord&) { return refusal; }), refusal);
  EXPECT_TRUE(store_->get_patient("anna").ok());
}

TEST_P(StoreTest, RefusesASecondPatientOfTheSameId) {
  add_patient("anna");
  const auto again = store_->create_patient({"anna", "other", {}, 1}, {});
  EXPECT_TRUE(absl::IsAlreadyExists(again.status())) << again.status();
  EXPECT_EQ(store_->get_patient("anna")->display_name, "");
}

TEST_P(StoreTest, ListsInPages) {
  for (const char* id : {"c", "a", "b", "d"}) add_patient(id);
  std::vector<std::string> ids;
  const auto patients = store_->list_patients({}, {"a", 2});
  ASSERT_TRUE(patients.ok());
  for (const auto& patient : *patients) ids.push_back(patient.id);
  EXPECT_THAT(ids, ElementsAre("b", "c"));
}

TEST_P(StoreTest, ListsWhatAScopeHas) {
  ASSERT_TRUE(store_->create_patient({"a", "", {}, 1, "ward"}, {}).ok());
  ASSERT_TRUE(store_->create_patient({"b", "", {}, 1, "ward"}, {}).ok());
  ASSERT_TRUE(store_->create_patient({"c", "", {}, 1, "clinic"}, {}).ok());
  for (const char* patient : {"a", "b", "c"}) {
    SimulationRecord record = simulation(absl::StrCat("of-", patient));
    record.model = absl::StrCat("patients/", patient, "/models/m");
    record.tenant = patient == std::string("c") ? "clinic" : "ward";
    ASSERT_TRUE(store_->create_simulation(record, {}).ok());
  }
  const auto ids = [this](const Scope& scope) {
    std::vector<std::string> found;
    const auto patients = store_->list_patients(scope, {"", 10});
    const auto simulations = store_->list_simulations(scope, {"", 10});
    EXPECT_TRUE(patients.ok() && simulations.ok()) << patients.status() << simulations.status();
    for (const auto& patient : patients.value()) found.push_back(patient.id);
    for (const auto& one : simulations.value()) found.push_back(one.id);
    return found;
  };
  EXPECT_THAT(ids({}), ElementsAre());
  EXPECT_THAT(ids({"ward"}), ElementsAre("a", "b", "of-a", "of-b"));
  EXPECT_THAT(ids({"clinic"}), ElementsAre("c", "of-c"));
  EXPECT_THAT(ids({"ward", {{"b", "c", "nobody"}}}), ElementsAre("b", "of-b"));
  EXPECT_THAT(ids({"ward", std::set<std::string>{}}), ElementsAre());
  EXPECT_EQ(store_->owner_of_simulation("of-c")->tenant, "clinic");
  EXPECT_EQ(store_->owner_of_simulation("of-c")->patient, "c");
  EXPECT_EQ(store_->get_simulation("of-c")->tenant, "clinic");
  EXPECT_TRUE(absl::IsNotFound(store_->owner_of_patient("x").status()));
  EXPECT_TRUE(absl::IsNotFound(store_->owner_of_simulation("x").status()));
}

TEST_P(StoreTest, ARequestIdIsATenantsOwn) {
  const RequestKey ours{"CreatePatient", "r1", "f1", "ward"};
  const RequestKey theirs{"CreatePatient", "r1", "f1", "clinic"};
  ASSERT_TRUE(store_->create_patient({"a", "", {}, 1, "ward"}, ours).ok());
  const auto made = store_->create_patient({"b", "", {}, 1, "clinic"}, theirs);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->id, "b");
  EXPECT_EQ(**store_->find_request(ours), "patients/a");
}

TEST_P(StoreTest, RepeatsARequestOnlyOnce) {
  const RequestKey key{"CreatePatient", "r1", "f1"};
  ASSERT_TRUE(store_->create_patient({"anna", "first", {}, 1}, key).ok());
  reopen();
  const auto again = store_->create_patient({"berta", "second", {}, 2}, key);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->id, "anna");
  EXPECT_EQ(store_->list_patients({}, {"", 10})->size(), 1u);
  const auto other = store_->create_patient({"carl", "", {}, 1}, {"CreatePatient", "r1", "f2"});
  EXPECT_TRUE(absl::IsInvalidArgument(other.status())) << other.status();
}

TEST_P(StoreTest, ForgetsTheRequestOfWhatWasDeleted) {
  const RequestKey key{"CreatePatient", "r1", "f1"};
  ASSERT_TRUE(store_->create_patient({"anna", "", {}, 1}, key).ok());
  ASSERT_TRUE(store_->create_scan(scan("s1"), {"CreateScan", "r2", "f"}).ok());
  ASSERT_TRUE(store_->delete_patient("anna", true).ok());
  EXPECT_FALSE(store_->find_request({"CreateScan", "r2", "f"})->has_value());
  const auto again = store_->create_patient({"anna", "", {}, 9}, key);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->create_time_us, 9);
}

TEST_P(StoreTest, AFailedCreateLeavesNoRequestBehind) {
  const RequestKey key{"CreateScan", "r1", "f1"};
  EXPECT_TRUE(absl::IsNotFound(store_->create_scan(scan("s1"), key).status()));
  EXPECT_FALSE(store_->find_request(key)->has_value());
}

TEST_P(StoreTest, FollowsAnUpload) {
  add_patient("anna");
  ASSERT_TRUE(store_->create_scan(scan("s1"), {}).ok());
  ASSERT_TRUE(store_->set_scan_received("anna", "s1", 4'999'999'999).ok());
  ASSERT_TRUE(store_->complete_scan("anna", "s1", "report").ok());
  reopen();
  const auto record = store_->get_scan("anna", "s1");
  ASSERT_TRUE(record.ok());
  EXPECT_EQ(record->received_bytes, 4'999'999'999u);
  EXPECT_TRUE(record->complete);
  EXPECT_EQ(record->report_message, "report");
  EXPECT_TRUE(absl::IsNotFound(store_->set_scan_received("anna", "other", 1)));
}

TEST_P(StoreTest, HoldsOnToAScanThatAModelWasBuiltFrom) {
  add_patient("anna");
  ASSERT_TRUE(store_->create_scan(scan("s1"), {}).ok());
  ASSERT_TRUE(store_->create_model({"anna", "m1", "s1", "hash", "spec", "report", 1, ""}, {}).ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(store_->delete_scan("anna", "s1")));
  const absl::Status refused = store_->delete_patient("anna", false);
  EXPECT_TRUE(absl::IsFailedPrecondition(refused));
  EXPECT_THAT(std::string(refused.message()), HasSubstr("1 scans and 1 models"));
  ASSERT_TRUE(store_->delete_model("anna", "m1").ok());
  EXPECT_TRUE(store_->delete_scan("anna", "s1").ok());
  EXPECT_TRUE(store_->delete_patient("anna", false).ok());
}

TEST_P(StoreTest, HoldsOnToTheBoneOfAModelToo) {
  add_patient("anna");
  ASSERT_TRUE(store_->create_scan(scan("s1"), {}).ok());
  ASSERT_TRUE(store_->create_scan(scan("b1"), {}).ok());
  ASSERT_TRUE(store_->create_model({"anna", "m1", "s1", "hash", "spec", "report", 1, "b1"}, {}).ok());
  reopen();
  EXPECT_EQ(store_->get_model("anna", "m1")->bone_scan, "b1");
  EXPECT_TRUE(absl::IsFailedPrecondition(store_->delete_scan("anna", "b1")));
  EXPECT_TRUE(absl::IsNotFound(store_->create_model({"anna", "m2", "s1", "h", "", "", 1, "b2"}, {}).status()));
  ASSERT_TRUE(store_->delete_model("anna", "m1").ok());
  EXPECT_TRUE(store_->delete_scan("anna", "b1").ok());
}

TEST_P(StoreTest, RefusesAModelOfAScanThatIsGone) {
  add_patient("anna");
  EXPECT_TRUE(absl::IsNotFound(store_->create_model({"anna", "m1", "s1", "h", "", "", 1, ""}, {}).status()));
  EXPECT_TRUE(store_->list_models("anna", {"", 10})->empty());
}

TEST_P(StoreTest, KeepsAResultWhole) {
  ASSERT_TRUE(store_->create_simulation(simulation("x"), {}).ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(store_->get_result("x").status()));
  SimulationRecord ended = simulation("x");
  ended.state = SimulationState::kSettled;
  ended.reason = "at rest";
  ended.summary_message = std::string("\0\1", 2);
  ASSERT_TRUE(store_->end_simulation(ended, {"meshes", "frame"}).ok());
  reopen();
  const auto record = store_->get_simulation("x");
  ASSERT_TRUE(record.ok());
  EXPECT_EQ(record->state, SimulationState::kSettled);
  EXPECT_EQ(record->summary_message, ended.summary_message);
  EXPECT_EQ(record->spec_message, simulation("x").spec_message);
  EXPECT_EQ(store_->get_result("x")->frame_message, "frame");
}

TEST_P(StoreTest, FindsSeriesByStep) {
  ASSERT_TRUE(store_->create_simulation(simulation("x"), {}).ok());
  ASSERT_TRUE(store_->append_series("x", {1, 500, "first"}).ok());
  ASSERT_TRUE(store_->append_series("x", {501, 700, "second"}).ok());
  EXPECT_EQ((**store_->next_series_chunk("x", 0)).rows_message, "first");
  EXPECT_EQ((**store_->next_series_chunk("x", 499)).rows_message, "first");
  EXPECT_EQ((**store_->next_series_chunk("x", 500)).rows_message, "second");
  EXPECT_FALSE(store_->next_series_chunk("x", 700)->has_value());
  ASSERT_TRUE(store_->delete_simulation("x").ok());
  EXPECT_FALSE(store_->next_series_chunk("x", 0)->has_value());
}

TEST_P(StoreTest, ListsWhatHasNotEnded) {
  for (const char* id : {"ready", "ended"}) ASSERT_TRUE(store_->create_simulation(simulation(id), {}).ok());
  SimulationRecord ended = simulation("ended");
  ended.state = SimulationState::kStopped;
  ASSERT_TRUE(store_->end_simulation(ended, {}).ok());
  const auto unended = store_->list_unended_simulations();
  ASSERT_TRUE(unended.ok());
  ASSERT_EQ(unended->size(), 1u);
  EXPECT_EQ(unended->front().id, "ready");
  EXPECT_EQ(unended->front().spec_message, simulation("ready").spec_message);
}

TEST_P(StoreTest, HoldsOnToTheModelOfASimulationThatHasNotEnded) {
  add_patient("anna");
  ASSERT_TRUE(store_->create_model({"anna", "m", "", "hash", "spec", "report", 1, ""}, {}).ok());
  ASSERT_TRUE(store_->create_model({"anna", "m2", "", "hash", "spec", "report", 1, ""}, {}).ok());
  ASSERT_TRUE(store_->create_simulation(simulation("x"), {}).ok());
  const absl::Status refused = store_->delete_model("anna", "m");
  EXPECT_TRUE(absl::IsFailedPrecondition(refused));
  EXPECT_THAT(std::string(refused.message()), HasSubstr("simulations/x"));
  EXPECT_TRUE(absl::IsFailedPrecondition(store_->delete_patient("anna", true)));
  EXPECT_TRUE(store_->delete_model("anna", "m2").ok());
  SimulationRecord ended = simulation("x");
  ended.state = SimulationState::kStopped;
  ASSERT_TRUE(store_->end_simulation(ended, {}).ok());
  EXPECT_TRUE(store_->delete_patient("anna", true).ok());
}

TEST_P(StoreTest, ServesManyThreads) {
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([this, t] {
      for (int i = 0; i < 25; ++i) {
        const std::string id = absl::StrCat("p", t, "-", i);
        EXPECT_TRUE(store_->create_patient({id, "", {{"t", std::to_string(t)}}, i}, {}).ok());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(store_->list_patients({}, {"", 1000})->size(), 100u);
}

TEST(StoreOpening, RefusesAFileThatIsNoDatabase) {
  lipofill::testing::TemporaryDirectory directory;
  std::ofstream(directory.file("db")) << std::string(8192, 'x');
  const auto store = SqlStore::open(directory.file("db"));
  EXPECT_EQ(store.status().code(), absl::StatusCode::kDataLoss) << store.status();
}

TEST(StoreOpening, RefusesANewerSchemaAndOthersDatabases) {
  lipofill::testing::TemporaryDirectory directory;
  ASSERT_TRUE(SqlStore::open(directory.file("new")).ok());
  ASSERT_TRUE((*SqliteDatabase::open(directory.file("new")))->execute("PRAGMA user_version = 99").ok());
  const auto newer = SqlStore::open(directory.file("new"));
  EXPECT_TRUE(absl::IsFailedPrecondition(newer.status()));
  EXPECT_THAT(std::string(newer.status().message()), HasSubstr("version 99"));
  ASSERT_TRUE((*SqliteDatabase::open(directory.file("other")))->execute("CREATE TABLE t (x)").ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(SqlStore::open(directory.file("other")).status()));
}

TEST(StoreOpening, RefusesAPlaceThatCannotBeWritten) {
  EXPECT_FALSE(SqlStore::open("/proc/nothing/db").ok());
}

TEST(DataDirectoryTest, BelongsToOneDaemon) {
  lipofill::testing::TemporaryDirectory directory;
  {
    const auto first = DataDirectory::open(directory.path() / "data");
    ASSERT_TRUE(first.ok()) << first.status();
    EXPECT_TRUE(absl::IsFailedPrecondition(DataDirectory::open(directory.path() / "data").status()));
  }
  EXPECT_TRUE(DataDirectory::open(directory.path() / "data").ok());
}

TEST_P(StoreTest, TheOwnerOfASimulationIsThatOfTheOneThereIsNow) {
  SimulationRecord record = simulation("x");
  record.tenant = "ward";
  ASSERT_TRUE(store_->create_simulation(record, {}).ok());
  EXPECT_EQ(store_->owner_of_simulation("x")->tenant, "ward");
  EXPECT_EQ(store_->owner_of_simulation("x")->patient, "anna");
  ASSERT_TRUE(store_->delete_simulation("x").ok());
  EXPECT_TRUE(absl::IsNotFound(store_->owner_of_simulation("x").status()));
  record.tenant = "clinic";
  record.model = "patients/berta/models/m";
  ASSERT_TRUE(store_->create_simulation(record, {}).ok());
  EXPECT_EQ(store_->owner_of_simulation("x")->tenant, "clinic");
  EXPECT_EQ(store_->owner_of_simulation("x")->patient, "berta");
}

INSTANTIATE_TEST_SUITE_P(EveryKind, StoreTest, ::testing::Values(StoreKind::kSqlite, StoreKind::kPostgres), kind_name);

}  // namespace
}  // namespace lipofill::server
