#include "server/store/scan_files.h"

#include <gtest/gtest.h>

#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

TEST(ScanFiles, WritesAtOffsetsAndReadsBack) {
  lipofill::testing::TemporaryDirectory directory;
  const auto files = ScanFiles::open(directory.path() / "scans");
  ASSERT_TRUE(files.ok());
  EXPECT_EQ(files->size("anna", "s1"), 0u);
  ASSERT_TRUE(files->write("anna", "s1", 0, "hello ").ok());
  ASSERT_TRUE(files->write("anna", "s1", 6, std::string("w\0rld", 5)).ok());
  EXPECT_EQ(files->size("anna", "s1"), 11u);
  EXPECT_TRUE(files->flush("anna", "s1").ok());
  EXPECT_FALSE(files->flush("anna", "none").ok());
  EXPECT_EQ(*files->read("anna", "s1"), std::string("hello w\0rld", 11));
  files->remove("anna", "s1");
  EXPECT_EQ(files->size("anna", "s1"), 0u);
  EXPECT_FALSE(files->read("anna", "s1").ok());
  EXPECT_FALSE(std::filesystem::exists(directory.path() / "scans" / "anna"));
}

TEST(ScanFiles, SweepsWhatNobodyKnows) {
  lipofill::testing::TemporaryDirectory directory;
  const auto files = ScanFiles::open(directory.path());
  ASSERT_TRUE(files.ok());
  for (const char* scan : {"known", "lost"}) ASSERT_TRUE(files->write("anna", scan, 0, "x").ok());
  EXPECT_EQ(files->sweep([](const std::string&, const std::string& scan) { return scan == "known"; }), 1);
  EXPECT_EQ(files->size("anna", "known"), 1u);
  EXPECT_EQ(files->size("anna", "lost"), 0u);
}

}  // namespace
}  // namespace lipofill::server
