#include "server/entry/caller_account.h"

#include <gmock/gmock.h>

#include <string>

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

TEST(CallerAccount, BoundsOneCallerAndAll) {
  CallerAccount account({100, 40}, "answers");
  EXPECT_TRUE(account.take("anna", 40).ok());
  const absl::Status own = account.take("anna", 1);
  EXPECT_TRUE(absl::IsResourceExhausted(own));
  EXPECT_THAT(std::string(own.message()), HasSubstr("answers of yours would take 41 bytes, may take 40"));
  EXPECT_TRUE(account.take("bert", 40).ok());
  const absl::Status all = account.take("carl", 30);
  EXPECT_THAT(std::string(all.message()), HasSubstr("answers of all callers would take 110 bytes, may take 100"));
  EXPECT_TRUE(account.take("carl", 20).ok());
  EXPECT_EQ(account.bytes(), 100u);
}

TEST(CallerAccount, CountsNoMoreWhatWasGivenBack) {
  CallerAccount account({100, 40}, "answers");
  ASSERT_TRUE(account.take("anna", 40).ok());
  account.give_back("anna", 30);
  EXPECT_EQ(account.bytes_of("anna"), 10u);
  EXPECT_TRUE(account.take("anna", 30).ok());
  account.give_back("anna", 40);
  EXPECT_EQ(account.bytes(), 0u);
}

TEST(CallerAccount, TheOnlyThingOfACallerMayBeLargerWhereThatIsSo) {
  CallerAccount account({100, 40, true}, "streams");
  EXPECT_TRUE(account.take("anna", 90).ok());
  EXPECT_FALSE(account.take("anna", 1).ok());
  EXPECT_FALSE(account.take("bert", 90).ok()) << "but not than what all may have";
  EXPECT_TRUE(account.take("bert", 10).ok());
}

}  // namespace
}  // namespace lipofill::server
