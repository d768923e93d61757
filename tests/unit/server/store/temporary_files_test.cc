#include "server/store/temporary_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/unit/server/store/full_store.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

namespace fs = std::filesystem;

class TemporaryFilesTest : public ::testing::Test {
 protected:
  bool is_there(const std::string& path) const { return fs::exists(data_ / path); }
  void write(const std::string& path) const {
    fs::create_directories((data_ / path).parent_path());
    std::ofstream(data_ / path) << "bytes";
  }

  lipofill::testing::TemporaryDirectory directory_;
  const fs::path data_ = directory_.path() / "data";
  std::unique_ptr<SqlStore> store_ = make_full_store(data_);
  TemporaryFiles files_{*store_, data_};
};

TEST_F(TemporaryFilesTest, FilesGoWithTheirRecordsHoweverThoseGo) {
  EXPECT_EQ(files_.sweep(), 0);
  ASSERT_TRUE(is_there("scans/anna/scan-1") && is_there("checkpoints/sim-1/kept-1"));
  ASSERT_TRUE(store_->delete_patient("anna", true).ok());
  ASSERT_TRUE(store_->delete_simulation("sim-1").ok());
  files_.remove_deleted();
  EXPECT_FALSE(is_there("scans/anna"));
  EXPECT_FALSE(is_there("checkpoints/sim-1"));
  EXPECT_TRUE(store_->list_temporary_files()->empty());
}

TEST_F(TemporaryFilesTest, AFileWithoutARecordIsNotTouched) {
  write("scans/anna/of-no-record");
  write("checkpoints/other/of-no-record");
  files_.remove_deleted();
  EXPECT_EQ(files_.sweep(), 0);
  EXPECT_TRUE(is_there("scans/anna/of-no-record"));
  EXPECT_TRUE(is_there("checkpoints/other/of-no-record"));
}

TEST_F(TemporaryFilesTest, WhatWasBeingWrittenGoesWithTheNextStartAlone) {
  ASSERT_TRUE(files_.begin(checkpoint_path("sim-1", "half")).ok());
  write("checkpoints/sim-1/half");
  write("checkpoints/sim-1/half.draft");
  files_.remove_deleted();
  EXPECT_TRUE(is_there("checkpoints/sim-1/half"));
  EXPECT_EQ(files_.sweep(), 1);
  EXPECT_FALSE(is_there("checkpoints/sim-1/half"));
  EXPECT_FALSE(is_there("checkpoints/sim-1/half.draft"));
  EXPECT_TRUE(is_there("checkpoints/sim-1/kept-1"));
}

TEST_F(TemporaryFilesTest, ARecordTakesTheNoteAway) {
  ASSERT_TRUE(files_.begin(checkpoint_path("sim-1", "new")).ok());
  write("checkpoints/sim-1/new");
  CheckpointRecord record;
  record.simulation = "sim-1";
  record.id = "new";
  ASSERT_TRUE(store_->create_checkpoint(record, std::nullopt, {}).ok());
  EXPECT_EQ(files_.sweep(), 0);
  EXPECT_TRUE(is_there("checkpoints/sim-1/new"));
}

TEST_F(TemporaryFilesTest, ANoteThatRottedLeadsNowhere) {
  write("precious");
  for (const char* path : {"precious", "scans/../precious", "/precious", "scans/x", "scans/a/../../precious", ""}) {
    ASSERT_TRUE(files_.begin(path).ok());
  }
  for (const char* path : {"scans/anna/scan-1", "checkpoints/sim-1/kept-1"}) ASSERT_TRUE(files_.begin(path).ok());
  files_.sweep();
  EXPECT_TRUE(is_there("precious"));
  EXPECT_TRUE(is_there("scans/anna/scan-1")) << "there is a record of it";
  EXPECT_TRUE(is_there("checkpoints/sim-1/kept-1"));
}

}  // namespace
}  // namespace lipofill::server
