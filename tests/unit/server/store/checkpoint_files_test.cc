#include "server/store/checkpoint_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <fstream>

#include "absl/strings/str_cat.h"
#include "server/store/durable_file.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

CheckpointContent sample() {
  return {"x", 1234567890123, std::string("a\0b", 3), std::string(300, '\x7f') + "end"};
}

TEST(CheckpointFormat, GivesBackWhatWentIn) {
  const auto content = decode_checkpoint(encode_checkpoint(sample()));
  ASSERT_TRUE(content.ok()) << content.status();
  EXPECT_EQ(content->simulation, "x");
  EXPECT_EQ(content->step, 1234567890123u);
  EXPECT_EQ(content->spec_message, sample().spec_message);
  EXPECT_EQ(content->snapshot, sample().snapshot);
}

TEST(CheckpointFormat, RefusesEveryFlippedBit) {
  std::string bytes = encode_checkpoint(sample());
  for (size_t i = 0; i < bytes.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      bytes[i] = static_cast<char>(bytes[i] ^ (1 << bit));
      EXPECT_TRUE(absl::IsDataLoss(decode_checkpoint(bytes).status())) << "byte " << i << " bit " << bit;
      bytes[i] = static_cast<char>(bytes[i] ^ (1 << bit));
    }
  }
  EXPECT_TRUE(decode_checkpoint(bytes).ok());
}

TEST(CheckpointFormat, RefusesEveryOtherLength) {
  const std::string bytes = encode_checkpoint(sample());
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_TRUE(absl::IsDataLoss(decode_checkpoint(bytes.substr(0, size)).status())) << size;
  }
  EXPECT_TRUE(absl::IsDataLoss(decode_checkpoint(bytes + "x").status()));
}

TEST(CheckpointFormat, NamesAFormatOfALaterProgram) {
  std::string bytes = encode_checkpoint(sample());
  bytes[8] = 9;
  EXPECT_THAT(decode_checkpoint(bytes).status().ToString(), HasSubstr("format is 9, this program knows 1"));
}

class CheckpointFilesTest : public ::testing::Test {
 protected:
  CheckpointFilesTest() : files_(*CheckpointFiles::open(directory_.path() / "checkpoints")) {}
  std::filesystem::path path(const std::string& id) { return directory_.path() / "checkpoints" / "x" / id; }

  lipofill::testing::TemporaryDirectory directory_;
  CheckpointFiles files_;
};

TEST_F(CheckpointFilesTest, ReadsOnlyWhatItWrote) {
  const auto written = files_.write("x", "c1", sample());
  ASSERT_TRUE(written.ok()) << written.status();
  EXPECT_EQ(written->size_bytes, std::filesystem::file_size(path("c1")));
  EXPECT_EQ(written->sha256.size(), 64u);
  EXPECT_EQ(files_.read("x", "c1", written->sha256)->snapshot, sample().snapshot);
  // A whole checkpoint, but another one.
  CheckpointContent other = sample();
  other.step = 5;
  ASSERT_TRUE(files_.write("x", "c1", other).ok());
  EXPECT_TRUE(absl::IsDataLoss(files_.read("x", "c1", written->sha256).status()));
  EXPECT_TRUE(absl::IsNotFound(files_.read("x", "c2", written->sha256).status()));
}

TEST_F(CheckpointFilesTest, AnOwnersDirectoryGoesWithItsLastFile) {
  for (const char* id : {"c1", "c2"}) ASSERT_TRUE(files_.write("x", id, sample()).ok());
  files_.remove("x", "c1");
  EXPECT_TRUE(std::filesystem::exists(path("c2")));
  files_.remove("x", "c2");
  EXPECT_FALSE(std::filesystem::exists(path("c2").parent_path()));
}

TEST_F(CheckpointFilesTest, AFullDiskLeavesTheOldFileAndNoHalfOne) {
  const auto written = files_.write("x", "c1", sample());
  ASSERT_TRUE(written.ok());
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{100, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto refused = files_.write("x", "c1", sample());
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status())) << refused.status();
  EXPECT_TRUE(files_.read("x", "c1", written->sha256).ok());
  EXPECT_FALSE(std::filesystem::exists(path("c1.draft")));
}

TEST_F(CheckpointFilesTest, BoundsWhatItReads) {
  ASSERT_TRUE(files_.write("x", "c1", sample()).ok());
  const auto refused = read_whole_file(path("c1"), 100);
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status()));
  EXPECT_THAT(refused.status().ToString(), HasSubstr("the bound is 100"));
  // A sparse file larger than any checkpoint costs nothing to refuse.
  std::filesystem::resize_file(path("c1"), kMaxCheckpointBytes + 1);
  EXPECT_TRUE(absl::IsResourceExhausted(files_.read("x", "c1", "").status()));
}

}  // namespace
}  // namespace lipofill::server
