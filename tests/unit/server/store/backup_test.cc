#include "server/store/backup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "server/store/checkpoint_files.h"
#include "server/store/data_directory.h"
#include "server/store/durable_file.h"
#include "server/store/scan_files.h"
#include "server/store/sql_store.h"
#include "server/store/sqlite_database.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class BackupTest : public ::testing::Test {
 protected:
  BackupTest() {
    const auto scans = ScanFiles::open(data() / "scans");
    EXPECT_TRUE(scans->write("anna", "s1", 0, "the bytes of a scan").ok());
    EXPECT_TRUE(scans->write("anna", "orphan", 0, "of no record").ok());
    auto store = SqlStore::open((data() / "lipofill.sqlite").string());
    EXPECT_TRUE(store.ok()) << store.status();
    EXPECT_TRUE((*store)->create_patient({"anna", "a-1", {}, 1}, {}).ok());
    for (const char* id : {"s1", "s2"}) {
      ScanRecord scan;
      scan.patient = "anna";
      scan.id = id;
      scan.size_bytes = 19;
      scan.sha256 = "d5e3c1d6418e52b7b3d375786ade650ec129a77c1c9b3171a256aa71376f8025";
      scan.complete = std::string(id) == "s1";
      EXPECT_TRUE((*store)->create_scan(scan, {}).ok());
    }
    store_ = *std::move(store);
  }
  fs::path data() const { return fs::path(directory_.path()) / "data"; }
  fs::path target() const { return fs::path(directory_.path()) / "backup"; }
  fs::path other() const { return fs::path(directory_.path()) / "other"; }
  absl::StatusOr<BackupReport> back_up() {
    return back_up_store(data(), target(), [](const auto&) {});
  }
  absl::StatusOr<BackupReport> restore() {
    return restore_store(target(), other(), [](const auto&) {});
  }

  lipofill::testing::TemporaryDirectory directory_;
  std::unique_ptr<SqlStore> store_;  ///< open all the time, as a daemon's is
};

TEST_F(BackupTest, RestoresWhatThereWasAndNoMore) {
  const auto report = back_up();
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->files, 2) << "the database and the one scan whose bytes have come";
  EXPECT_FALSE(fs::exists(target() / "scans/anna/orphan"));
  for (const auto& entry : fs::directory_iterator(data())) {
    EXPECT_NE(entry.path().filename().string().rfind("backup-", 0), 0u) << entry.path();
  }
  ASSERT_TRUE(store_->create_patient({"later", "", {}, 2}, {}).ok());

  const auto restored = restore();
  ASSERT_TRUE(restored.ok()) << restored.status();
  EXPECT_EQ(restored->files, 2);
  const auto store = SqlStore::open((other() / "lipofill.sqlite").string());
  ASSERT_TRUE(store.ok()) << store.status();
  EXPECT_EQ((*store)->get_patient("anna")->display_name, "a-1");
  EXPECT_TRUE(absl::IsNotFound((*store)->get_patient("later").status()));
  EXPECT_EQ(*ScanFiles::open(other() / "scans")->read("anna", "s1"), "the bytes of a scan");
}

TEST_F(BackupTest, RefusesATargetThatExistsAndASourceThatDoesNot) {
  ASSERT_TRUE(back_up().ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(back_up().status()));
  EXPECT_TRUE(absl::IsFailedPrecondition(
      back_up_store(other(), fs::path(directory_.path()) / "b", [](const auto&) {}).status()));
  EXPECT_TRUE(absl::IsFailedPrecondition(restore_store(other(), data(), [](const auto&) {}).status()));
  EXPECT_TRUE(absl::IsFailedPrecondition(restore_store(target(), data(), [](const auto&) {}).status()))
      << "there is a store";
}

TEST_F(BackupTest, ADamagedBackupChangesNothing) {
  ASSERT_TRUE(back_up().ok());
  std::ofstream(target() / "scans/anna/s1", std::ios::app) << "!";
  const auto damaged = restore();
  EXPECT_TRUE(absl::IsDataLoss(damaged.status()));
  EXPECT_THAT(damaged.status().ToString(), HasSubstr("scans/anna/s1 is not what was backed up"));
  fs::remove(target() / "scans/anna/s1");
  EXPECT_TRUE(absl::IsDataLoss(restore().status()));
  EXPECT_FALSE(fs::exists(other() / "lipofill.sqlite"));
  EXPECT_FALSE(fs::exists(other() / "scans"));
}

TEST_F(BackupTest, WhatIsDamagedIsNamedAndTheRestIsKept) {
  ASSERT_TRUE(ScanFiles::open(data() / "scans")->write("anna", "s1", 4, "B").ok());
  ASSERT_TRUE((*SqliteDatabase::open((data() / "lipofill.sqlite").string()))
                  ->execute("UPDATE scans SET sum = zeroblob(32) WHERE id = x'7332'")
                  .ok());
  const auto report = back_up();
  ASSERT_TRUE(report.ok()) << report.status();
  ASSERT_EQ(report->damages.size(), 2u);
  EXPECT_EQ(report->damages[0].name, "patients/anna/scans/s2");
  EXPECT_EQ(report->damages[1].name, "patients/anna/scans/s1");
  EXPECT_THAT(report->damages[1].what, HasSubstr("is not what was uploaded"));
  EXPECT_THAT(*read_whole_file(target() / "DAMAGED", 10'000), HasSubstr("patients/anna/scans/s1: its file"));
  const auto restored = restore();
  ASSERT_TRUE(restored.ok()) << restored.status();
  EXPECT_EQ(restored->damages.size(), 2u);
  const auto store = SqlStore::open((other() / "lipofill.sqlite").string());
  EXPECT_TRUE((*store)->get_patient("anna").ok());
  EXPECT_TRUE(absl::IsDataLoss((*store)->get_scan("anna", "s2").status()));
}

TEST_F(BackupTest, RestoresOnlyWhereThereIsNothingOfAStore) {
  ASSERT_TRUE(back_up().ok());
  ASSERT_TRUE(ScanFiles::open(other() / "scans")->write("anna", "s1", 0, "of another store").ok());
  const auto refused = restore();
  EXPECT_TRUE(absl::IsFailedPrecondition(refused.status())) << refused.status();
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("scans/anna/s1"));
}

TEST_F(BackupTest, ANameThatLeadsOutOfTheBackupIsRefused) {
  ASSERT_TRUE(back_up().ok());
  for (const char* path : {"../outside", "/etc/passwd", "scans/../../outside"}) {
    std::ofstream(target() / "SHA256SUMS", std::ios::app) << std::string(64, 'a') << "  " << path << "\n";
    EXPECT_TRUE(absl::IsDataLoss(restore().status())) << path;
  }
}

}  // namespace
}  // namespace lipofill::server
