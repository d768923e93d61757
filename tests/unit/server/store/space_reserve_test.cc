#include "server/store/space_reserve.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

constexpr uint64_t kBytes = 1'000'000;

class SpaceReserveTest : public ::testing::Test {
 protected:
  /// Bytes of the medium that the file takes.
  int64_t held() const {
    struct stat about {};
    return ::stat(file_.c_str(), &about) == 0 ? int64_t{about.st_blocks} * 512 : 0;
  }

  lipofill::testing::TemporaryDirectory directory_;
  const std::string file_ = directory_.file("reserve");
  SpaceReserve reserve_{file_, kBytes};
};

TEST_F(SpaceReserveTest, HoldsRoomAndNotOnlyAFileOfThatSize) {
  EXPECT_TRUE(reserve_.fill());
  EXPECT_GE(held(), static_cast<int64_t>(kBytes));
  EXPECT_TRUE(reserve_.fill()) << "it has it";
}

TEST_F(SpaceReserveTest, LetsGoOfItForWorkThatFindsNoRoomAndTakesItBack) {
  ASSERT_TRUE(reserve_.fill());
  int attempts = 0;
  const absl::Status done = reserve_.spend([&] {
    ++attempts;
    return held() > 0 ? absl::ResourceExhaustedError("no room") : absl::OkStatus();
  });
  EXPECT_TRUE(done.ok()) << done;
  EXPECT_EQ(attempts, 2);
  EXPECT_GT(held(), 0);
}

TEST_F(SpaceReserveTest, IsNotSpentOnOtherTroubles) {
  ASSERT_TRUE(reserve_.fill());
  EXPECT_TRUE(absl::IsNotFound(reserve_.spend([] { return absl::NotFoundError("there is none"); })));
  EXPECT_GT(held(), 0);
}

TEST_F(SpaceReserveTest, WithoutAnyTheTroubleIsTold) {
  int attempts = 0;
  const auto work = [&] {
    ++attempts;
    return absl::ResourceExhaustedError("no room");
  };
  EXPECT_TRUE(absl::IsResourceExhausted(reserve_.spend(work)));
  EXPECT_EQ(attempts, 1) << "nothing was held";
  SpaceReserve none(directory_.file("none"), 0);
  EXPECT_FALSE(none.fill());
  EXPECT_TRUE(absl::IsResourceExhausted(none.spend(work)));
}

}  // namespace
}  // namespace lipofill::server
