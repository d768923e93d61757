// Databases of every earlier version, made from the schema text of that version, and damaged ones.

#include "server/store/schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "absl/strings/str_cat.h"
#include "server/store/row_sums.h"
#include "server/store/sql_store.h"
#include "server/store/sqlite_database.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

/// As version 1 wrote it.
constexpr char kVersion1[] = R"(
CREATE TABLE patients (
  id BLOB PRIMARY KEY, display_name BLOB NOT NULL, create_time_us INTEGER NOT NULL) WITHOUT ROWID;
CREATE TABLE patient_labels (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, key BLOB NOT NULL, value BLOB NOT NULL,
  PRIMARY KEY (patient, key)) WITHOUT ROWID;
CREATE TABLE scans (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, id BLOB NOT NULL, format INTEGER NOT NULL,
  unit INTEGER NOT NULL, size_bytes INTEGER NOT NULL, sha256 BLOB NOT NULL, received_bytes INTEGER NOT NULL,
  complete INTEGER NOT NULL, report BLOB NOT NULL, create_time_us INTEGER NOT NULL, PRIMARY KEY (patient, id));
CREATE TABLE models (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, id BLOB NOT NULL, scan BLOB NOT NULL,
  content_hash BLOB NOT NULL, spec BLOB NOT NULL, report BLOB NOT NULL, create_time_us INTEGER NOT NULL,
  PRIMARY KEY (patient, id));
CREATE TABLE simulations (
  id BLOB PRIMARY KEY, model BLOB NOT NULL, display_name BLOB NOT NULL, spec BLOB NOT NULL, state INTEGER NOT NULL,
  reason BLOB NOT NULL, summary BLOB NOT NULL, create_time_us INTEGER NOT NULL);
CREATE TABLE simulation_results (
  simulation BLOB PRIMARY KEY REFERENCES simulations(id) ON DELETE CASCADE, meshes BLOB NOT NULL, frame BLOB NOT NULL);
CREATE TABLE simulation_series (
  simulation BLOB NOT NULL REFERENCES simulations(id) ON DELETE CASCADE, first_step INTEGER NOT NULL,
  last_step INTEGER NOT NULL, rows BLOB NOT NULL, PRIMARY KEY (simulation, last_step));
CREATE TABLE requests (
  method BLOB NOT NULL, id BLOB NOT NULL, fingerprint BLOB NOT NULL, name BLOB NOT NULL,
  PRIMARY KEY (method, id)) WITHOUT ROWID;
CREATE INDEX requests_by_name ON requests(name);
PRAGMA application_id = 0x4c69706f;
PRAGMA user_version = 1;
)";

/// Version 2 differs in the models' table alone.
constexpr char kVersion2[] = R"(
DROP TABLE models;
CREATE TABLE models (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, id BLOB NOT NULL, scan BLOB NOT NULL,
  content_hash BLOB NOT NULL, spec BLOB NOT NULL, report BLOB NOT NULL, create_time_us INTEGER NOT NULL,
  bone_scan BLOB NOT NULL DEFAULT x'', PRIMARY KEY (patient, id));
PRAGMA user_version = 2;
)";

/// Version 3 logs commands and has checkpoints.
constexpr char kVersion3[] = R"(
ALTER TABLE simulations ADD COLUMN epoch INTEGER NOT NULL DEFAULT 0;
ALTER TABLE simulations ADD COLUMN origin BLOB NOT NULL DEFAULT x'';
CREATE TABLE simulation_commands (
  simulation BLOB NOT NULL REFERENCES simulations(id) ON DELETE CASCADE, number INTEGER NOT NULL,
  kind INTEGER NOT NULL, step INTEGER NOT NULL, payload BLOB NOT NULL, on_course INTEGER NOT NULL,
  create_time_us INTEGER NOT NULL, PRIMARY KEY (simulation, number)) WITHOUT ROWID;
CREATE TABLE checkpoints (
  simulation BLOB NOT NULL REFERENCES simulations(id) ON DELETE CASCADE, id BLOB NOT NULL, kind INTEGER NOT NULL,
  on_course INTEGER NOT NULL, step INTEGER NOT NULL, time_s REAL NOT NULL, wall_s REAL NOT NULL,
  last_command INTEGER NOT NULL, size_bytes INTEGER NOT NULL, sha256 BLOB NOT NULL, state_hash BLOB NOT NULL,
  create_time_us INTEGER NOT NULL, PRIMARY KEY (simulation, id));
PRAGMA user_version = 3;
)";

/// Version 4 has tenants.
constexpr char kVersion4[] = R"(
ALTER TABLE patients ADD COLUMN tenant BLOB NOT NULL DEFAULT x'6c6f63616c';
ALTER TABLE simulations ADD COLUMN tenant BLOB NOT NULL DEFAULT x'6c6f63616c';
DROP TABLE requests;
CREATE TABLE requests (
  tenant BLOB NOT NULL, method BLOB NOT NULL, id BLOB NOT NULL, fingerprint BLOB NOT NULL, name BLOB NOT NULL,
  PRIMARY KEY (tenant, method, id)) WITHOUT ROWID;
CREATE INDEX requests_by_name ON requests(name);
CREATE INDEX patients_by_tenant ON patients(tenant, id);
CREATE INDEX simulations_by_tenant ON simulations(tenant, id);
PRAGMA user_version = 4;
)";

/// Version 5 knows itself, sums its rows, and records files that may be removed.
constexpr char kVersion5[] = R"(
CREATE TABLE store (id BLOB NOT NULL, starts INTEGER NOT NULL);
INSERT INTO store SELECT CAST(lower(hex(randomblob(16))) AS BLOB), 0;
CREATE TABLE temporary_files (path BLOB PRIMARY KEY, is_draft INTEGER NOT NULL) WITHOUT ROWID;
CREATE TRIGGER files_of_scans AFTER DELETE ON scans BEGIN
  INSERT OR REPLACE INTO temporary_files
    VALUES (CAST('scans/' || CAST(OLD.patient AS TEXT) || '/' || CAST(OLD.id AS TEXT) AS BLOB), 0); END;
CREATE TRIGGER files_of_checkpoints AFTER DELETE ON checkpoints BEGIN
  INSERT OR REPLACE INTO temporary_files
    VALUES (CAST('checkpoints/' || CAST(OLD.simulation AS TEXT) || '/' || CAST(OLD.id AS TEXT) AS BLOB), 0); END;
CREATE TRIGGER recorded_checkpoints AFTER INSERT ON checkpoints BEGIN
  DELETE FROM temporary_files
    WHERE path = CAST('checkpoints/' || CAST(NEW.simulation AS TEXT) || '/' || CAST(NEW.id AS TEXT) AS BLOB); END;
PRAGMA user_version = 5;
)";

/// The sums of version 5: what is summed since then.
std::string sums_of_version_5() {
  std::string statements = make_row_sums(0);
  return statements.substr(0, statements.find("\nALTER TABLE plans "));
}

/// Version 6 has plans.
constexpr char kVersion6[] = R"(
CREATE TABLE plans (
  patient BLOB NOT NULL REFERENCES patients(id) ON DELETE CASCADE, id BLOB NOT NULL, revision INTEGER NOT NULL,
  scan BLOB NOT NULL, target BLOB NOT NULL, content BLOB NOT NULL, create_time_us INTEGER NOT NULL,
  update_time_us INTEGER NOT NULL, PRIMARY KEY (patient, id));
CREATE TABLE plan_revisions (
  patient BLOB NOT NULL, plan BLOB NOT NULL, number INTEGER NOT NULL, content BLOB NOT NULL, changes BLOB NOT NULL,
  create_time_us INTEGER NOT NULL, PRIMARY KEY (patient, plan, number),
  FOREIGN KEY (patient, plan) REFERENCES plans(patient, id) ON DELETE CASCADE);
CREATE TABLE plan_runs (
  simulation BLOB PRIMARY KEY REFERENCES simulations(id) ON DELETE CASCADE, patient BLOB NOT NULL,
  plan BLOB NOT NULL, content_hash BLOB NOT NULL, create_time_us INTEGER NOT NULL,
  FOREIGN KEY (patient, plan) REFERENCES plans(patient, id) ON DELETE CASCADE);
CREATE INDEX plan_runs_by_plan ON plan_runs(patient, plan);
PRAGMA user_version = 6;
)";

/// Makes the sums that version 6 keeps.
std::string sums_of_version_6() {
  std::string statements = make_row_sums(5);
  return statements.substr(0, statements.find("\nALTER TABLE operations "));
}

constexpr char kContent[] = R"(
INSERT INTO patients (id, display_name, create_time_us) VALUES (x'61', x'6e616d65', 1);
INSERT INTO patient_labels VALUES (x'61', x'6b', x'76');
INSERT INTO scans VALUES (x'61', x'73', 2, 1, 5000000000, x'6162', 12, 0, x'', 2);
INSERT INTO models (patient, id, scan, content_hash, spec, report, create_time_us)
  VALUES (x'61', x'6d', x'73', x'68617368', x'00ff', x'72', 3);
INSERT INTO simulations (id, model, display_name, spec, state, reason, summary, create_time_us) VALUES (x'72', x'6d', x'', x'70', 1, x'', x'', 4), (x'73', x'6d', x'', x'70', 4, x'', x'75', 5);
INSERT INTO simulation_results VALUES (x'73', x'6d', x'66');
INSERT INTO simulation_series VALUES (x'73', 1, 500, x'77');
)";
constexpr char kRequest[] = "INSERT INTO requests VALUES (x'43', x'31', x'66', x'70')";
constexpr char kRequestOfTenant[] = "INSERT INTO requests VALUES (x'6c6f63616c', x'43', x'31', x'66', x'70')";

/// Every column of every table and every index, as the database sees them.
std::set<std::string> shape_of(const std::string& path) {
  const auto database = SqliteDatabase::open(path);
  EXPECT_TRUE(database.ok());
  std::set<std::string> shape;
  Query tables(**database,
               "SELECT m.type, m.name, c.cid, c.name, c.type, c.\"notnull\", coalesce(c.dflt_value, ''), c.pk "
               "FROM sqlite_master m LEFT JOIN pragma_table_info(m.name) c ORDER BY 1, 2, 3");
  while (tables.next()) {
    std::string line;
    for (int i = 0; i < 8; ++i) absl::StrAppend(&line, tables.text(i), "|");
    shape.insert(line);
  }
  EXPECT_TRUE(tables.status().ok()) << tables.status();
  return shape;
}

class SchemaTest : public ::testing::TestWithParam<int> {
 protected:
  void make(int version) {
    const auto database = SqliteDatabase::open(path_);
    ASSERT_TRUE(database.ok());
    ASSERT_TRUE((*database)->execute(kVersion1).ok());
    ASSERT_TRUE((*database)->execute(version >= 2 ? kVersion2 : "").ok());
    ASSERT_TRUE((*database)->execute(version >= 3 ? kVersion3 : "").ok());
    ASSERT_TRUE((*database)->execute(version >= 4 ? kVersion4 : "").ok());
    ASSERT_TRUE((*database)->execute(kContent).ok());
    ASSERT_TRUE((*database)->execute(version >= 4 ? kRequestOfTenant : kRequest).ok());
    ASSERT_TRUE((*database)->execute(version >= 5 ? kVersion5 : "").ok());
    ASSERT_TRUE((*database)->execute(version >= 5 ? sums_of_version_5().c_str() : "").ok());
    ASSERT_TRUE((*database)->execute(version >= 6 ? kVersion6 : "").ok());
    ASSERT_TRUE((*database)->execute(version >= 6 ? sums_of_version_6().c_str() : "").ok());
  }
  lipofill::testing::TemporaryDirectory directory_;
  std::string path_ = directory_.file("db");
};

TEST_P(SchemaTest, IsBroughtUpToDateWithAllItHeld) {
  make(GetParam());
  for (int round = 0; round < 2; ++round) {
    const auto store = SqlStore::open(path_);
    ASSERT_TRUE(store.ok()) << store.status();
    EXPECT_EQ((*store)->get_patient("a")->labels.at("k"), "v");
    EXPECT_EQ((*store)->get_scan("a", "s")->size_bytes, 5'000'000'000u);
    const auto model = (*store)->get_model("a", "m");
    ASSERT_TRUE(model.ok()) << model.status();
    EXPECT_EQ(model->content_hash, "hash");
    EXPECT_EQ(model->spec_message, std::string("\0\xff", 2));
    EXPECT_EQ(model->bone_scan, "");
    EXPECT_EQ((*store)->get_simulation("s")->state, SimulationState::kSettled);
    EXPECT_EQ((*store)->get_simulation("s")->origin, "");
    EXPECT_EQ((*store)->get_result("s")->frame_message, "f");
    EXPECT_EQ((**(*store)->next_series_chunk("s", 0)).rows_message, "w");
    EXPECT_EQ(**(*store)->find_request({"C", "1", "f"}), "p");
    const auto unended = (*store)->list_unended_simulations();
    ASSERT_TRUE(unended.ok()) << unended.status();
    if (GetParam() < 3) {
      EXPECT_EQ((*store)->get_simulation("r")->state, SimulationState::kFailed) << "it was lost with its daemon";
      EXPECT_EQ((*store)->get_simulation("r")->reason, "the daemon stopped");
      EXPECT_TRUE(unended->empty());
    } else {
      ASSERT_EQ(unended->size(), 1u);
      EXPECT_EQ(unended->front().id, "r");
    }
    EXPECT_TRUE((*store)->list_plans({}, "a", {}, 1)->empty());
    EXPECT_TRUE((*store)->list_operations()->empty());
    EXPECT_EQ((*store)->owner_of_patient("a")->tenant, "local") << "what there was is the machine's own user's";
    EXPECT_EQ((*store)->owner_of_simulation("s")->tenant, "local");
    EXPECT_EQ((*store)->list_patients({}, {"", 10})->size(), 1u);
    EXPECT_TRUE((*store)->list_patients({"other"}, {"", 10})->empty());
  }
}

TEST_P(SchemaTest, EndsInTheShapeOfANewOne) {
  make(GetParam());
  ASSERT_TRUE(SqlStore::open(path_).ok());
  ASSERT_TRUE(SqlStore::open(directory_.file("new")).ok());
  EXPECT_EQ(shape_of(path_), shape_of(directory_.file("new")));
}

TEST_P(SchemaTest, StaysAsItIsWhenTheChangeFails) {
  make(GetParam());
  // One of the last changes finds its name taken.
  ASSERT_TRUE((*SqliteDatabase::open(path_))->execute("CREATE TABLE operation_parts (x)").ok());
  const std::set<std::string> before = shape_of(path_);
  EXPECT_FALSE(SqlStore::open(path_).ok());
  EXPECT_EQ(shape_of(path_), before);
}

INSTANTIATE_TEST_SUITE_P(EveryEarlierVersion, SchemaTest, ::testing::Range(1, kSchemaVersion));

TEST(DamagedDatabase, IsRefusedWithWhatToDo) {
  lipofill::testing::TemporaryDirectory directory;
  const std::string path = directory.file("db");
  {
    const auto store = SqlStore::open(path);
    ASSERT_TRUE(store.ok());
    for (int i = 0; i < 200; ++i) {
      ASSERT_TRUE((*store)->create_patient({absl::StrCat("patient-", i), std::string(60, 'n'), {}, i}, {}).ok());
    }
  }
  const auto size = std::filesystem::file_size(path);
  ASSERT_GT(size, 5u * 4096);
  int refused = 0;
  for (size_t page = 1; page < size / 4096; ++page) {
    const std::string copy = directory.file("copy");
    std::filesystem::copy_file(path, copy, std::filesystem::copy_options::overwrite_existing);
    {
      std::fstream file(copy, std::ios::in | std::ios::out | std::ios::binary);
      file.seekp(static_cast<std::streamoff>(page * 4096));
      file << std::string(4096, '\xa5');
    }
    const auto store = SqlStore::open(copy);
    if (store.ok()) continue;
    ++refused;
    EXPECT_TRUE(absl::IsDataLoss(store.status())) << page << ": " << store.status();
    EXPECT_THAT(std::string(store.status().message()), HasSubstr("is damaged"));
    EXPECT_THAT(std::string(store.status().message()), HasSubstr("Put a backup in its place"));
  }
  EXPECT_EQ(refused, static_cast<int>(size / 4096) - 1)
      << "a page that belongs to a table or an index is missed by none";
}

}  // namespace
}  // namespace lipofill::server
