#include "server/security/authenticator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/base/error_hints.h"
#include "core/base/field_violations.h"
#include "server/security/allowance.h"
#include "tests/unit/server/security/key_fixture.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using lipofill::testing::good_claims;
using lipofill::testing::SigningKey;

constexpr char kMap[] = R"({"certificates": [{"common_name": "wall", "tenant": "ward", "roles": ["viewer"]},
                                             {"common_name": "guest", "tenant": "clinic", "roles": ["viewer"]}]})";

class AuthenticatorTest : public ::testing::Test {
 protected:
  AuthenticatorTest() {
    std::ofstream(directory_.file("keys")) << key_.public_pem();
    std::ofstream(directory_.file("map")) << kMap;
    settings_.token_issuer = "https://id.example";
    settings_.token_audience = "lipofill";
  }
  void use_tokens() { settings_.token_keys_file = directory_.file("keys"); }
  void use_certificates() { settings_.client_certificates_file = directory_.file("map"); }

  /// "subject@tenant", or why not.
  std::string who(const Credentials& credentials) {
    const auto authenticator = Authenticator::open(settings_);
    EXPECT_TRUE(authenticator.ok()) << authenticator.status();
    const auto principal = (*authenticator)->identify(credentials);
    if (!principal.ok()) return hints_of(principal.status())->reason;
    return principal->subject + "@" + principal->scope.tenant;
  }
  static Credentials holder_of(const std::string& name) {
    Credentials credentials;
    credentials.has_certificate = true;
    credentials.common_names = {name};
    return credentials;
  }
  Credentials bearer(const std::string& prefix = "Bearer ") {
    Credentials credentials;
    credentials.authorization = {prefix + key_.token(good_claims())};
    return credentials;
  }

  lipofill::testing::TemporaryDirectory directory_;
  const SigningKey key_ = SigningKey::p256();
  SecuritySettings settings_;
};

TEST_F(AuthenticatorTest, WithoutAuthenticationEverybodyIsTheUserOfTheMachine) {
  EXPECT_EQ(who({}), "local@local");
  EXPECT_EQ(who(bearer()), "local@local");
  EXPECT_EQ((*Authenticator::open(settings_))->identify({})->role, Role::kAdmin);
}

TEST_F(AuthenticatorTest, KnowsTheBearersOfTokens) {
  use_tokens();
  EXPECT_EQ(who(bearer()), "dr-grey@ward");
  EXPECT_EQ(who(bearer("bearer ")), "dr-grey@ward");
  EXPECT_EQ(who(bearer("")), "TOKEN_MALFORMED");
  EXPECT_EQ(who(bearer("Basic ")), "TOKEN_MALFORMED");
  EXPECT_EQ(who({}), "NO_CREDENTIALS");
  Credentials two = bearer();
  two.authorization.push_back(two.authorization.front());
  EXPECT_EQ(who(two), "TOKEN_MALFORMED");
  EXPECT_EQ(who(holder_of("wall")), "NO_CREDENTIALS") << "certificates are not set up";
}

TEST_F(AuthenticatorTest, KnowsTheHoldersOfCertificates) {
  use_certificates();
  EXPECT_EQ(who(holder_of("wall")), "wall@ward");
  EXPECT_EQ(who(holder_of("nobody")), "CERTIFICATE_UNKNOWN");
  EXPECT_EQ(who(bearer()), "NO_CREDENTIALS") << "tokens are not set up";
  Credentials unverified = holder_of("wall");
  unverified.has_certificate = false;
  EXPECT_EQ(who(unverified), "NO_CREDENTIALS");
}

TEST_F(AuthenticatorTest, ATokenSaysMoreThanTheCertificateItCameWith) {
  use_tokens();
  use_certificates();
  Credentials both = bearer();
  both.has_certificate = true;
  both.common_names = {"wall"};
  EXPECT_EQ(who(both), "dr-grey@ward");
  both.common_names = {"nobody"};
  EXPECT_EQ(who(both), "dr-grey@ward") << "the certificate of a machine, the token of who sits at it";
  both.common_names = {"guest"};
  EXPECT_EQ(who(both), "CREDENTIALS_DISAGREE");
  both.authorization = {"Bearer a.b.c"};
  both.common_names = {"wall"};
  EXPECT_EQ(who(both), "TOKEN_MALFORMED") << "a bad token is not made good by a certificate";
}

TEST_F(AuthenticatorTest, TrustsUnixSocketsWhereTold) {
  use_tokens();
  Credentials local;
  local.is_unix_socket = true;
  EXPECT_EQ(who(local), "NO_CREDENTIALS");
  settings_.trust_unix_sockets = true;
  EXPECT_EQ(who(local), "local@local");
  EXPECT_EQ(who({}), "NO_CREDENTIALS");
  local.authorization = bearer().authorization;
  EXPECT_EQ(who(local), "dr-grey@ward");
  local.authorization = {"Bearer a.b.c"};
  EXPECT_EQ(who(local), "TOKEN_MALFORMED");
}

TEST_F(AuthenticatorTest, SaysWhichFilesCannotBeUsed) {
  settings_.token_keys_file = directory_.file("none");
  std::ofstream(directory_.file("map")) << "{";
  use_certificates();
  const auto violations = field_violations_of(Authenticator::open(settings_).status());
  ASSERT_EQ(violations.size(), 2u);
  EXPECT_EQ(violations[0].field, "token-keys-file");
  EXPECT_EQ(violations[1].field, "client-certificates-file");
}

TEST(Allowance, GivesSoManyInAPeriod) {
  Allowance allowance(2, std::chrono::seconds(10));
  const Allowance::Clock::time_point start = Allowance::Clock::now();
  EXPECT_TRUE(allowance.take(start));
  EXPECT_TRUE(allowance.take(start));
  EXPECT_FALSE(allowance.take(start + std::chrono::seconds(9)));
  EXPECT_TRUE(allowance.take(start + std::chrono::seconds(10)));
}

TEST(Principal, RolesAndTenantsAreWords) {
  for (const Role role : {Role::kViewer, Role::kPlanner, Role::kAdmin}) EXPECT_EQ(role_of(role_name(role)), role);
  EXPECT_EQ(role_of("none"), Role::kNone);
  EXPECT_EQ(role_of(""), Role::kNone);
  EXPECT_TRUE(is_tenant("ward3"));
  for (const char* bad : {"", "3ward", "ward-3", "Ward", "w\xc3\xa4rd", "a/b", "aaaaaaaaaabbbbbbbbbbccccccccccdd"}) {
    EXPECT_FALSE(is_tenant(bad)) << bad;
  }
}

}  // namespace
}  // namespace lipofill::server
