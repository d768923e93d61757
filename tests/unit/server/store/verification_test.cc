#include "server/store/verification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/unit/server/store/full_store.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class VerificationTest : public ::testing::Test {
 protected:
  VerificationTest() { make_full_store(data_); }
  Verification look() {
    auto found = verify_store(data_, (data_ / "lipofill.sqlite").string(), [](const Verification&) {});
    EXPECT_TRUE(found.ok()) << found.status();
    return found.ok() ? *std::move(found) : Verification();
  }
  void flip(const fs::path& path, size_t at) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(static_cast<std::streamoff>(at));
    const int byte = file.get();
    file.seekp(static_cast<std::streamoff>(at));
    file.put(static_cast<char>(byte ^ 4));
  }

  lipofill::testing::TemporaryDirectory directory_;
  const fs::path data_ = directory_.path() / "data";
  const fs::path scan_ = data_ / "scans" / "anna" / "scan-1";
  const fs::path checkpoint_ = data_ / "checkpoints" / "sim-1" / "kept-1";
};

TEST_F(VerificationTest, FindsNothingInAWholeStore) {
  const Verification found = look();
  EXPECT_TRUE(found.is_whole()) << found.damages.front().name << ": " << found.damages.front().what;
  EXPECT_EQ(found.records, 15u) << "one of each table";
  EXPECT_EQ(found.files, 2u);
  EXPECT_EQ(found.bytes, fs::file_size(scan_) + fs::file_size(checkpoint_));
}

TEST_F(VerificationTest, NamesWhatABitWasFlippedOf) {
  for (size_t at = 0; at < fs::file_size(scan_); ++at) {
    flip(scan_, at);
    const Verification found = look();
    ASSERT_EQ(found.damages.size(), 1u) << at;
    EXPECT_EQ(found.damages.front().name, "patients/anna/scans/scan-1");
    flip(scan_, at);
  }
  for (size_t at = 0; at < fs::file_size(checkpoint_); ++at) {
    flip(checkpoint_, at);
    const Verification found = look();
    ASSERT_EQ(found.damages.size(), 1u) << at;
    EXPECT_EQ(found.damages.front().name, "simulations/sim-1/checkpoints/kept-1");
    flip(checkpoint_, at);
  }
  EXPECT_TRUE(look().is_whole());
}

TEST_F(VerificationTest, NamesFilesThatAreMissing) {
  fs::remove(scan_);
  fs::remove(checkpoint_);
  const Verification found = look();
  ASSERT_EQ(found.damages.size(), 2u);
  EXPECT_THAT(found.damages[0].what, HasSubstr("is missing"));
  EXPECT_THAT(found.damages[1].what, HasSubstr("is missing"));
}

TEST_F(VerificationTest, SaysThatThereIsNoStore) {
  fs::resize_file(data_ / "lipofill.sqlite", 0);
  EXPECT_TRUE(absl::IsFailedPrecondition(
      verify_store(data_, (data_ / "lipofill.sqlite").string(), [](const Verification&) {}).status()));
  EXPECT_TRUE(absl::IsFailedPrecondition(
      verify_store(directory_.path(), directory_.file("lipofill.sqlite"), [](const Verification&) {}).status()));
}

}  // namespace
}  // namespace lipofill::server
