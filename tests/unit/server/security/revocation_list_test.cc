#include "server/security/revocation_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

using std::chrono::seconds;
using ::testing::HasSubstr;

Principal somebody(const std::string& tenant, const std::string& subject) {
  Principal principal;
  principal.scope.tenant = tenant;
  principal.subject = subject;
  return principal;
}

RevocationList list(const std::string& entries) {
  const auto parsed = RevocationList::parse(R"({"revoked": [)" + entries + "]}");
  EXPECT_TRUE(parsed.ok()) << parsed.status();
  return parsed.ok() ? *parsed : RevocationList();
}

std::string refusal(const std::string& text) {
  return std::string(RevocationList::parse(text).status().message());
}

TEST(RevocationList, HasATokenByItsId) {
  const RevocationList revoked = list(R"({"token_id": "8f3a"})");
  Principal principal = somebody("ward", "dr-grey");
  EXPECT_FALSE(revoked.has(principal));
  principal.token_id = "8f3b";
  EXPECT_FALSE(revoked.has(principal));
  principal.token_id = "8f3a";
  EXPECT_TRUE(revoked.has(principal));
}

TEST(RevocationList, HasASubjectOfATenant) {
  const RevocationList revoked = list(R"({"tenant": "ward", "subject": "dr-grey"})");
  EXPECT_TRUE(revoked.has(somebody("ward", "dr-grey")));
  EXPECT_FALSE(revoked.has(somebody("clinic", "dr-grey")));
  EXPECT_FALSE(revoked.has(somebody("ward", "dr-greyson")));
}

TEST(RevocationList, LeavesTokensThatWereIssuedLater) {
  const RevocationList revoked = list(R"({"tenant": "ward", "subject": "dr-grey", "issued_before": 1000})");
  Principal principal = somebody("ward", "dr-grey");
  EXPECT_TRUE(revoked.has(principal)) << "a token that does not say when it was issued";
  principal.issued = Principal::Clock::time_point(seconds(999));
  EXPECT_TRUE(revoked.has(principal));
  principal.issued = Principal::Clock::time_point(seconds(1000));
  EXPECT_FALSE(revoked.has(principal));
}

TEST(RevocationList, OfTwoEntriesTheOneThatRevokesMoreHolds) {
  const std::string early = R"({"tenant": "ward", "subject": "a", "issued_before": 1000})";
  const std::string late = R"({"tenant": "ward", "subject": "a", "issued_before": 2000})";
  const std::string all = R"({"tenant": "ward", "subject": "a"})";
  Principal principal = somebody("ward", "a");
  principal.issued = Principal::Clock::time_point(seconds(1500));
  EXPECT_TRUE(list(early + "," + late).has(principal));
  EXPECT_TRUE(list(late + "," + early).has(principal));
  principal.issued = Principal::Clock::time_point(seconds(2500));
  EXPECT_FALSE(list(late + "," + early).has(principal));
  EXPECT_TRUE(list(all + "," + early).has(principal));
  EXPECT_TRUE(list(early + "," + all).has(principal));
}

TEST(RevocationList, MistakesAreNamed) {
  EXPECT_THAT(refusal("[]"), HasSubstr("must be JSON, {\"revoked\": [...]}"));
  EXPECT_THAT(refusal(R"({"revoked": [], "more": 1})"), HasSubstr("must be JSON"));
  EXPECT_THAT(refusal(R"({"revoked": [{"token_id": "a"}, {"jti": "b"}]})"),
              HasSubstr("revoked[1]: has the unknown member \"jti\""));
  EXPECT_THAT(refusal(R"({"revoked": [{"subject": "a"}]})"), HasSubstr("revoked[0]: must have token_id alone"));
  EXPECT_THAT(refusal(R"({"revoked": [{"token_id": ""}]})"), HasSubstr("token_id is \"\", which it cannot be"));
  EXPECT_THAT(refusal(R"({"revoked": [{"tenant": "a", "subject": "b", "issued_before": "now"}]})"),
              HasSubstr("issued_before is \"now\""));
  EXPECT_TRUE(RevocationList::parse(R"({"revoked": []})").ok());
}

}  // namespace
}  // namespace lipofill::server
