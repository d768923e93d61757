#include "server/store/scan_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

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

TEST(ScanFiles, ReadsOnlyWhatWasUploaded) {
  lipofill::testing::TemporaryDirectory directory;
  const auto files = ScanFiles::open(directory.path());
  ASSERT_TRUE(files.ok());
  ASSERT_TRUE(files->write("anna", "s", 0, "abc").ok());
  constexpr char kSha256[] = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  EXPECT_EQ(*files->read_whole("anna", "s", kSha256), "abc");
  ASSERT_TRUE(files->write("anna", "s", 1, "c").ok());
  const auto damaged = files->read_whole("anna", "s", kSha256);
  EXPECT_TRUE(absl::IsDataLoss(damaged.status())) << damaged.status();
  EXPECT_THAT(std::string(damaged.status().message()), HasSubstr("patients/anna/scans/s is damaged"));
  files->remove("anna", "s");
  EXPECT_TRUE(absl::IsDataLoss(files->read_whole("anna", "s", kSha256).status()));
}

TEST(ScanFiles, ListsWhatNobodyKnowsAndRemovesNothing) {
  lipofill::testing::TemporaryDirectory directory;
  const auto files = ScanFiles::open(directory.path());
  ASSERT_TRUE(files.ok());
  for (const char* scan : {"known", "lost"}) ASSERT_TRUE(files->write("anna", scan, 0, "x").ok());
  const auto unknown =
      files->files().list_unknown([](const std::string&, const std::string& scan) { return scan == "known"; });
  EXPECT_THAT(unknown, ElementsAre(std::filesystem::path("anna/lost")));
  EXPECT_EQ(files->size("anna", "lost"), 1u);
}

TEST(ScanFiles, KnowsWhenBytesLastCame) {
  lipofill::testing::TemporaryDirectory directory;
  const auto files = ScanFiles::open(directory.path());
  ASSERT_TRUE(files.ok());
  EXPECT_EQ(files->last_write_us("anna", "s"), 0);
  ASSERT_TRUE(files->write("anna", "s", 0, "x").ok());
  constexpr int64_t kIn2026Us = 1'767'225'600'000'000;
  EXPECT_GT(files->last_write_us("anna", "s"), kIn2026Us);
}

}  // namespace
}  // namespace lipofill::server
