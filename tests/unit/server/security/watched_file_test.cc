#include "server/security/watched_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using Numbers = WatchedFile<int>;

absl::StatusOr<int> parse_number(const std::string& text) {
  if (text.find_first_not_of("0123456789") != std::string::npos) return absl::InvalidArgumentError("no number");
  return std::stoi(text);
}

class WatchedFileTest : public ::testing::Test {
 protected:
  /// As whoever replaces a file should: beside it, then in its place.
  void replace(const std::string& text) {
    std::ofstream(path_ + ".new") << text;
    std::filesystem::rename(path_ + ".new", path_);
  }
  /// Until the file says so, for some seconds at most.
  static bool comes_to_say(Numbers& file, int number) {
    for (int i = 0; i < 1000 && *file.get() != number; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return *file.get() == number;
  }
  lipofill::testing::TemporaryDirectory directory_;
  const std::string path_ = directory_.file("number");
};

TEST_F(WatchedFileTest, IsReadAgainOnceItHasChanged) {
  replace("7");
  const auto file = Numbers::open(path_, parse_number);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(*(*file)->get(), 7);
  replace("8");
  EXPECT_TRUE(comes_to_say(**file, 8));
  replace("nothing");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  EXPECT_EQ(*(*file)->get(), 8) << "what it said before holds on";
  std::filesystem::remove(path_);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  EXPECT_EQ(*(*file)->get(), 8);
  replace("9");
  EXPECT_TRUE(comes_to_say(**file, 9));
}

TEST_F(WatchedFileTest, MustBeGoodAtTheStart) {
  EXPECT_TRUE(absl::IsInvalidArgument(Numbers::open(path_, parse_number).status()));
  replace("");
  EXPECT_FALSE(Numbers::open(path_, parse_number).ok());
  replace("x");
  EXPECT_EQ(Numbers::open(path_, parse_number).status().message(), "no number");
  replace(std::string((1 << 20) + 1, '1'));
  EXPECT_FALSE(Numbers::open(path_, parse_number).ok());
  EXPECT_FALSE(Numbers::open(directory_.file(""), parse_number).ok()) << "a folder";
}

}  // namespace
}  // namespace lipofill::server
