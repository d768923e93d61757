#include "server/store/store_opening.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "server/store/durable_file.h"
#include "tests/unit/server/store/full_store.h"
#include "tests/unit/server/store/store_kinds.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class StoreOpeningTest : public ::testing::Test {
 protected:
  absl::StatusOr<OpenedStore> open(const fs::path& data) {
    const auto directory = DataDirectory::open(data);
    if (!directory.ok()) return directory.status();
    return open_store_to_serve(*directory, directory->database().string());
  }
  void expect_refused(const std::string& why) {
    const auto opened = open(data_);
    EXPECT_TRUE(absl::IsFailedPrecondition(opened.status())) << opened.status();
    EXPECT_THAT(std::string(opened.status().message()), HasSubstr(why));
    EXPECT_TRUE(fs::exists(data_ / "scans" / "anna" / "scan-1"));
  }

  lipofill::testing::TemporaryDirectory directory_;
  const fs::path data_ = directory_.path() / "data";
  const fs::path database_ = data_ / "lipofill.sqlite";
};

TEST_F(StoreOpeningTest, ANewDirectoryGetsAnIdThatStays) {
  const std::string id = open(data_)->store->read_identity()->id;
  EXPECT_EQ(id.size(), 32u);
  const auto again = open(data_);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->store->read_identity()->id, id);
  EXPECT_EQ(again->store->read_identity()->starts, 2u);
  EXPECT_EQ(again->remark, "");
  EXPECT_NE(open(directory_.path() / "other")->store->read_identity()->id, id);
}

TEST_F(StoreOpeningTest, AMissingOrEmptyDatabaseIsRefused) {
  make_full_store(data_);
  ASSERT_TRUE(open(data_).ok());
  fs::resize_file(database_, 0);
  expect_refused("lipofill.sqlite is empty, but there is");
  fs::remove(database_);
  expect_refused("lipofill.sqlite is missing, but there is");
  fs::remove(data_ / "store-id");
  expect_refused("scans/anna/scan-1: put the database back");
}

TEST_F(StoreOpeningTest, TheDatabaseOfAnotherDirectoryIsRefused) {
  make_full_store(data_);
  ASSERT_TRUE(open(data_).ok());
  make_full_store(directory_.path() / "other");
  fs::copy_file(directory_.path() / "other" / "lipofill.sqlite", database_, fs::copy_options::overwrite_existing);
  expect_refused("is the database of another data directory");
  fs::remove(data_ / "store-id");
  EXPECT_TRUE(open(data_).ok()) << "whoever says that they belong together is believed";
}

TEST_F(StoreOpeningTest, AnOlderDatabaseIsRemarkedUpon) {
  make_full_store(data_);
  ASSERT_TRUE(open(data_).ok());
  fs::copy_file(database_, directory_.file("older"));
  ASSERT_TRUE(open(data_).ok());
  ASSERT_TRUE(open(data_).ok());
  fs::copy_file(directory_.file("older"), database_, fs::copy_options::overwrite_existing);
  const auto opened = open(data_);
  ASSERT_TRUE(opened.ok()) << opened.status();
  EXPECT_THAT(opened->remark, HasSubstr("it knows of 1 starts, the directory of 3"));
  EXPECT_EQ(open(data_)->remark, "") << "once";
}

TEST_F(StoreOpeningTest, AnIdThatCannotBeReadIsNoReasonToGuess) {
  make_full_store(data_);
  ASSERT_TRUE(open(data_).ok());
  std::ofstream(data_ / "store-id") << "nonsense";
  expect_refused("does not say which store this is");
}

/// The same with a database of PostgreSQL, which any directory may name.
class SharedStoreOpeningTest : public ::testing::Test {
 protected:
  absl::StatusOr<OpenedStore> open(const fs::path& data, const std::string& place) {
    const auto directory = DataDirectory::open(data);
    if (!directory.ok()) return directory.status();
    return open_store_to_serve(*directory, place);
  }
  void expect_refused(const fs::path& data, const std::string& place, const std::string& why) {
    const auto opened = open(data, place);
    EXPECT_TRUE(absl::IsFailedPrecondition(opened.status())) << opened.status();
    EXPECT_THAT(std::string(opened.status().message()), HasSubstr(why));
  }

  lipofill::testing::TemporaryDirectory directory_;
  const fs::path data_ = directory_.path() / "data";
  const std::string place_ = make_place(StoreKind::kPostgres, directory_);
};

TEST_F(SharedStoreOpeningTest, DirectoryAndDatabaseBelongTogether) {
  ASSERT_TRUE(open(data_, place_).ok());
  ASSERT_TRUE(open(data_, place_).ok());
  const fs::path other = directory_.path() / "other";
  const std::string other_place = make_place(StoreKind::kPostgres, directory_);
  ASSERT_TRUE(open(other, other_place).ok());
  expect_refused(data_, other_place, "is the database of another data directory");
  expect_refused(directory_.path() / "new", place_, "mount the directory that has its files");
}

TEST_F(SharedStoreOpeningTest, AStoreIsNotMadeAnewBesideTheFilesOfOne) {
  ASSERT_TRUE(open(data_, place_).ok());
  expect_refused(data_, make_place(StoreKind::kPostgres, directory_), "the database holds no store, but there is");
}

TEST_F(SharedStoreOpeningTest, ADirectoryIsGivenToAStoreByHand) {
  const auto first = open(data_, place_);
  ASSERT_TRUE(first.ok()) << first.status();
  const fs::path copy = directory_.path() / "copy";
  fs::create_directories(copy);
  std::ofstream(copy / "store-id") << first->store->read_identity()->id << " 0\n";
  EXPECT_TRUE(open(copy, place_).ok());
}

}  // namespace
}  // namespace lipofill::server
