#include "server/backend/abandoned_uploads.h"

#include <gtest/gtest.h>

#include "server/sessions/identifiers.h"
#include "tests/unit/server/backend/backend_fixture.h"

namespace lipofill::server {
namespace {

using std::chrono::seconds;

class AbandonedUploadsTest : public BackendTest {
 protected:
  void add_scan(const std::string& id, bool complete, int64_t create_time_us) {
    ScanRecord scan;
    scan.patient = "anna";
    scan.id = id;
    scan.size_bytes = 10;
    scan.complete = complete;
    scan.create_time_us = create_time_us;
    ASSERT_TRUE(store_->create_scan(scan, {}).ok());
  }
  bool has_scan(const std::string& id) { return store_->get_scan("anna", id).ok(); }
};

TEST_F(AbandonedUploadsTest, GoWithTheirBytesAfterTheTime) {
  add_scan("old", false, 0);
  ASSERT_TRUE(scans_->write("anna", "old", 0, "some").ok());
  const int64_t written_us = scans_->last_write_us("anna", "old");
  EXPECT_EQ(remove_abandoned_uploads(*backend_, seconds(100), written_us + 99'000'000), 0) << "bytes came since";
  EXPECT_TRUE(has_scan("old"));
  EXPECT_EQ(remove_abandoned_uploads(*backend_, seconds(100), written_us + 100'000'000), 1);
  EXPECT_FALSE(has_scan("old"));
  EXPECT_EQ(scans_->size("anna", "old"), 0u);
}

TEST_F(AbandonedUploadsTest, WhatIsCompleteOrNewStays) {
  add_scan("complete", true, 0);
  add_scan("announced", false, now_us());
  EXPECT_EQ(remove_abandoned_uploads(*backend_, seconds(100), now_us() + 50'000'000), 0);
  EXPECT_TRUE(has_scan("complete"));
  EXPECT_TRUE(has_scan("announced"));
  EXPECT_EQ(remove_abandoned_uploads(*backend_, seconds(100), now_us() + 200'000'000), 1) << "no byte ever came";
  EXPECT_TRUE(has_scan("complete"));
}

}  // namespace
}  // namespace lipofill::server
