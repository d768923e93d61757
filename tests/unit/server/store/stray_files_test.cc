#include "server/store/stray_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "server/store/sqlite_database.h"
#include "tests/unit/server/store/full_store.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

namespace fs = std::filesystem;

TEST(StrayFiles, AreSetAsideAndNotRemoved) {
  lipofill::testing::TemporaryDirectory directory;
  const fs::path data = directory.path() / "data";
  const auto store = make_full_store(data);
  const auto scans = ScanFiles::open(data / "scans");
  const auto checkpoints = CheckpointFiles::open(data / "checkpoints");
  EXPECT_EQ(set_strays_aside(*store, *scans, *checkpoints, data, 0)->files, 0);
  EXPECT_FALSE(fs::exists(data / "set-aside"));
  ASSERT_TRUE(scans->write("anna", "lost", 0, "a face").ok());
  ASSERT_TRUE(scans->write("berta", "lost", 0, "another").ok());
  ASSERT_TRUE(checkpoints->write("sim-1", "lost", {"sim-1", 1, "", ""}).ok());
  const auto strays = set_strays_aside(*store, *scans, *checkpoints, data, 1'000'000);
  ASSERT_TRUE(strays.ok()) << strays.status();
  EXPECT_EQ(strays->files, 3);
  EXPECT_EQ(strays->place, data / "set-aside" / "19700101T000001.000000Z");
  std::ifstream kept(strays->place / "scans" / "anna" / "lost");
  EXPECT_EQ(std::string((std::istreambuf_iterator<char>(kept)), {}), "a face");
  EXPECT_TRUE(fs::exists(strays->place / "scans" / "berta" / "lost"));
  EXPECT_TRUE(fs::exists(strays->place / "checkpoints" / "sim-1" / "lost"));
  EXPECT_FALSE(fs::exists(data / "scans" / "berta"));
  EXPECT_TRUE(fs::exists(data / "scans" / "anna" / "scan-1"));
  EXPECT_TRUE(fs::exists(data / "checkpoints" / "sim-1" / "kept-1"));
}

TEST(StrayFiles, ADamagedRecordKeepsItsFile) {
  lipofill::testing::TemporaryDirectory directory;
  const fs::path data = directory.path() / "data";
  const auto store = make_full_store(data);
  ASSERT_TRUE((*SqliteDatabase::open((data / "lipofill.sqlite").string()))
                  ->execute("UPDATE scans SET sum = zeroblob(32)")
                  .ok());
  ASSERT_FALSE(store->get_scan("anna", "scan-1").ok());
  EXPECT_EQ(
      set_strays_aside(*store, *ScanFiles::open(data / "scans"), *CheckpointFiles::open(data / "checkpoints"), data, 0)
          ->files,
      0);
}

}  // namespace
}  // namespace lipofill::server
