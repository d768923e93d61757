#include "server/store/postgres_address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(PostgresAddress, KeepsWhatIsGivenAndAddsWhatIsNot) {
  const auto address = parse_postgres_address("postgresql://anna@db.example:6000/lipo?connect_timeout=7");
  ASSERT_TRUE(address.ok()) << address.status();
  EXPECT_EQ(address->name, "postgresql://db.example:6000/lipo");
  EXPECT_THAT(address->settings, HasSubstr("user='anna'"));
  EXPECT_THAT(address->settings, HasSubstr("connect_timeout='7'"));
  EXPECT_THAT(address->settings, HasSubstr("tcp_user_timeout='10000'"));
}

TEST(PostgresAddress, QuotesItsParts) {
  const auto address = parse_postgres_address("postgresql://a%27b%5C@h/d");
  ASSERT_TRUE(address.ok()) << address.status();
  EXPECT_THAT(address->settings, HasSubstr("user='a\\'b\\\\'"));
}

TEST(PostgresAddress, RefusesAPasswordAndNeverRepeatsOne) {
  for (const char* text : {"postgresql://anna:geheim@h/d", "postgresql://h/d?password=geheim",
                           "postgresql://anna:geheim@h:port:port/d", "postgresql://h/d?geheim=1"}) {
    const auto address = parse_postgres_address(text);
    EXPECT_TRUE(absl::IsInvalidArgument(address.status())) << text;
    EXPECT_THAT(std::string(address.status().message()), Not(HasSubstr("geheim"))) << text;
  }
}

}  // namespace
}  // namespace lipofill::server
