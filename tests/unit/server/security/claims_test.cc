#include "server/security/claims.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error_hints.h"
#include "tests/unit/server/security/key_fixture.h"

namespace lipofill::server {
namespace {

using lipofill::testing::good_claims;
using Json = nlohmann::json;

constexpr int64_t kNow = 2'000'000'000;

std::string reason(const Json& claims) {
  const ClaimRules rules{"https://id.example", "lipofill", std::chrono::seconds(30)};
  const auto principal = read_claims(claims, rules, Principal::Clock::time_point(std::chrono::seconds(kNow)));
  return principal.ok() ? "" : hints_of(principal.status())->reason;
}

Json with(const char* claim, const Json& value) {
  Json claims = good_claims();
  claims["iat"] = kNow;
  claims["exp"] = kNow + 60;
  claims[claim] = value;
  return claims;
}

Json without(const char* claim) {
  Json claims = with("sub", "dr-grey");
  claims.erase(claim);
  return claims;
}

TEST(Claims, MustBeForThisDaemonAndFromItsIssuer) {
  EXPECT_EQ(reason(with("aud", "lipofill")), "");
  EXPECT_EQ(reason(with("aud", {"a", "lipofill"})), "");
  for (const Json& audience : {Json("other"), Json({"a", "b"}), Json(1), Json(), Json("lipofill2"), Json::object()}) {
    EXPECT_EQ(reason(with("aud", audience)), "TOKEN_AUDIENCE") << audience;
  }
  EXPECT_EQ(reason(without("aud")), "TOKEN_AUDIENCE");
  for (const Json& issuer : {Json("https://id.example/"), Json({"https://id.example"}), Json()}) {
    EXPECT_EQ(reason(with("iss", issuer)), "TOKEN_ISSUER") << issuer;
  }
  EXPECT_EQ(reason(without("iss")), "TOKEN_ISSUER");
}

TEST(Claims, HoldForATimeThatClocksMayDisagreeAboutByABound) {
  EXPECT_EQ(reason(with("exp", kNow - 29)), "");
  EXPECT_EQ(reason(with("exp", kNow - 30)), "TOKEN_EXPIRED");
  EXPECT_EQ(reason(with("exp", 0)), "TOKEN_EXPIRED");
  EXPECT_EQ(reason(without("exp")), "TOKEN_MALFORMED") << "a token must end";
  for (const Json& never : {Json("2000000060"), Json(-1), Json(1e300), Json(2e9), Json(~uint64_t{0}), Json(true)}) {
    EXPECT_EQ(reason(with("exp", never)), "TOKEN_MALFORMED") << never;
  }
  EXPECT_EQ(reason(with("nbf", kNow + 30)), "");
  EXPECT_EQ(reason(with("nbf", kNow + 31)), "TOKEN_NOT_YET_VALID");
  EXPECT_EQ(reason(with("nbf", 0)), "");
  EXPECT_EQ(reason(with("iat", kNow + 31)), "TOKEN_NOT_YET_VALID");
  EXPECT_EQ(reason(with("iat", "today")), "TOKEN_MALFORMED");
}

TEST(Claims, SayWhoIsWhatAndWhere) {
  for (const char* claim : {"sub", "tenant", "roles"}) EXPECT_EQ(reason(without(claim)), "TOKEN_MALFORMED") << claim;
  for (const Json& bad : {Json(""), Json(1), Json(std::string(257, 'x'))}) {
    EXPECT_EQ(reason(with("sub", bad)), "TOKEN_MALFORMED");
  }
  for (const Json& bad : {Json(""), Json("Ward"), Json("a-b"), Json("a.b"), Json("3rd"), Json(std::string(32, 'a'))}) {
    EXPECT_EQ(reason(with("tenant", bad)), "TOKEN_MALFORMED") << bad;
  }
  EXPECT_EQ(reason(with("roles", "admin")), "TOKEN_MALFORMED") << "a list, not a text";
  for (const Json& bad : {Json("ward-a"), Json({"Anna Smith"}), Json({1}), Json({""}), Json(std::vector<int>(300))}) {
    EXPECT_EQ(reason(with("patients", bad)), "TOKEN_MALFORMED") << bad;
  }
}

TEST(Claims, RolesThatAreNoneGiveNothing) {
  Principal principal;
  ASSERT_TRUE(read_rights({{"tenant", "ward"}, {"roles", {"root", 7, "Admin"}}}, principal).ok());
  EXPECT_EQ(principal.role, Role::kNone);
  EXPECT_FALSE(principal.scope.patients.has_value());
  ASSERT_TRUE(read_rights({{"tenant", "ward"}, {"roles", Json::array()}, {"patients", Json::array()}}, principal).ok());
  EXPECT_EQ(principal.role, Role::kNone);
  EXPECT_FALSE(principal.scope.has("ward", "ward-a")) << "no patient, not every one";
}

}  // namespace
}  // namespace lipofill::server
