// Tokens as an attacker would change them.

#include "server/security/token_verifier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <fstream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/error_hints.h"
#include "tests/unit/server/security/key_fixture.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using lipofill::testing::base64url;
using lipofill::testing::good_claims;
using lipofill::testing::SigningKey;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

class TokenVerifierTest : public ::testing::Test {
 protected:
  void trust(const std::string& keys) {
    std::ofstream(directory_.file("keys")) << keys;
    auto verifier = TokenVerifier::open(directory_.file("keys"), {"https://id.example", "lipofill"});
    ASSERT_TRUE(verifier.ok()) << verifier.status();
    verifier_ = *std::move(verifier);
  }
  /// Why the token is refused; "" where it is not.
  std::string reason(const std::string& token) {
    const auto principal = verifier_->verify(token);
    if (principal.ok()) return "";
    EXPECT_TRUE(absl::IsUnauthenticated(principal.status())) << principal.status();
    EXPECT_THAT(std::string(principal.status().message()), Not(HasSubstr("dr-grey")));
    return hints_of(principal.status())->reason;
  }
  static Json with(const char* claim, const Json& value) {
    Json claims = good_claims();
    claims[claim] = value;
    return claims;
  }

  lipofill::testing::TemporaryDirectory directory_;
  std::unique_ptr<TokenVerifier> verifier_;
};

TEST_F(TokenVerifierTest, TellsWhoATokenSpeaksOf) {
  for (const SigningKey& key : {SigningKey::rsa(), SigningKey::p256()}) {
    trust(key.public_pem());
    Json claims = good_claims();
    claims["roles"] = {"viewer", "admin", "gardener"};
    claims["patients"] = {"ward-a", "ward-b"};
    claims["aud"] = {"other", "lipofill"};
    const auto principal = verifier_->verify(key.token(claims));
    ASSERT_TRUE(principal.ok()) << principal.status();
    EXPECT_EQ(principal->subject, "dr-grey");
    EXPECT_EQ(principal->role, Role::kAdmin);
    EXPECT_EQ(principal->scope.tenant, "ward");
    EXPECT_THAT(*principal->scope.patients, ::testing::ElementsAre("ward-a", "ward-b"));
    EXPECT_FALSE(principal->has_expired());
    EXPECT_TRUE(principal->has_expired(Principal::Clock::now() + std::chrono::hours(2)));
  }
}

TEST_F(TokenVerifierTest, RefusesTheTokensOfOtherKeys) {
  const SigningKey ours = SigningKey::rsa();
  trust(ours.public_pem());
  EXPECT_EQ(reason(SigningKey::rsa().token(good_claims())), "TOKEN_SIGNATURE");
  EXPECT_EQ(reason(SigningKey::p256().token(good_claims())), "TOKEN_SIGNATURE");
  EXPECT_EQ(reason(ours.token(good_claims())), "");
}

TEST_F(TokenVerifierTest, RefusesNoAlgorithmAndAlgorithmsThatTheKeyIsNotFor) {
  const SigningKey key = SigningKey::rsa();
  trust(key.public_pem());
  for (const char* algorithm : {"none", "None", "NONE", "HS256", "RS384", "ES256", "rs256", "RS256 "}) {
    EXPECT_EQ(reason(key.token_with_header(good_claims(), Json{{"alg", algorithm}})), "TOKEN_SIGNATURE") << algorithm;
  }
  const std::string unsigned_part =
      absl::StrCat(base64url(R"({"alg":"none"})"), ".", base64url(good_claims().dump()), ".");
  EXPECT_EQ(reason(unsigned_part), "TOKEN_MALFORMED");
  EXPECT_EQ(reason(unsigned_part + "AA"), "TOKEN_SIGNATURE");
}

// The classic: the public key, which everybody has, taken for the secret of HS256.
TEST_F(TokenVerifierTest, RefusesThePublicKeyTakenForASharedSecret) {
  const std::string pem = SigningKey::rsa().public_pem();
  trust(pem);
  const std::string text =
      absl::StrCat(base64url(R"({"alg":"HS256","typ":"JWT"})"), ".", base64url(good_claims().dump()));
  unsigned char code[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  HMAC(EVP_sha256(), pem.data(), static_cast<int>(pem.size()), reinterpret_cast<const unsigned char*>(text.data()),
       text.size(), code, &size);
  const std::string forged = absl::StrCat(text, ".", base64url(std::string(reinterpret_cast<char*>(code), size)));
  EXPECT_EQ(reason(forged), "TOKEN_SIGNATURE");
}

TEST_F(TokenVerifierTest, RefusesWhatWasChangedAfterSigning) {
  for (const SigningKey& key : {SigningKey::rsa(), SigningKey::p256()}) {
    trust(key.public_pem());
    const std::string token = key.token(good_claims());
    const std::vector<std::string> parts = absl::StrSplit(token, '.');
    const std::string more = base64url(with("roles", {"admin"}).dump());
    EXPECT_EQ(reason(absl::StrCat(parts[0], ".", more, ".", parts[2])), "TOKEN_SIGNATURE");
    EXPECT_EQ(reason(absl::StrCat(parts[0], ".", parts[1], ".", parts[2].substr(0, parts[2].size() - 4))),
              "TOKEN_SIGNATURE");
    EXPECT_EQ(reason(absl::StrCat(parts[0], ".", parts[1], ".", base64url(std::string(64, '\0')))), "TOKEN_SIGNATURE");
    // The last character has bits that stand for nothing.
    for (size_t i = 0; i + 1 < token.size(); i += 13) {
      std::string changed = token;
      changed[i] = changed[i] == 'A' ? 'B' : 'A';
      EXPECT_NE(reason(changed), "") << "byte " << i;
    }
  }
}

TEST_F(TokenVerifierTest, RefusesWhatIsNoToken) {
  const SigningKey key = SigningKey::rsa();
  trust(key.public_pem());
  const std::string good = key.token(good_claims());
  for (const std::string& bad :
       {std::string(), std::string("."), std::string(".."), std::string("a.b.c"), good + ".x", good + "=", " " + good,
        good + "\n", std::string("\xff.\xfe.\x80"), std::string(9000, 'a'), std::string(8000, '.'),
        std::string(4000, 'a') + "." + std::string(4000, 'b') + ".c", base64url("[]") + "." + base64url("[]") + ".AAAA",
        base64url("{}") + "." + base64url("{}") + ".AAAA", base64url(R"({"alg":17})") + "." + base64url("{}") + ".AAAA",
        base64url(std::string(3000, '[')) + "." + base64url("{}") + ".AAAA"}) {
    EXPECT_EQ(reason(bad), "TOKEN_MALFORMED") << bad.substr(0, 60);
  }
  EXPECT_EQ(reason(key.token_with_header(good_claims(), Json{{"alg", "RS256"}, {"crit", {"exp"}}})), "TOKEN_MALFORMED");
  EXPECT_EQ(reason(key.token(with("sub", std::string(7000, 'x')))), "TOKEN_MALFORMED") << "huge";
}

TEST_F(TokenVerifierTest, TakesTheKeyThatATokenNamesAndFollowsTheFile) {
  const SigningKey a = SigningKey::rsa();
  const SigningKey b = SigningKey::p256();
  trust(Json{{"keys", {a.jwk("one"), b.jwk("two")}}}.dump());
  EXPECT_EQ(reason(a.token(good_claims(), "one")), "");
  EXPECT_EQ(reason(b.token(good_claims(), "two")), "");
  EXPECT_EQ(reason(b.token(good_claims())), "") << "which names none";
  EXPECT_EQ(reason(a.token(good_claims(), "two")), "TOKEN_SIGNATURE");
  EXPECT_EQ(reason(a.token(good_claims(), "../../etc/passwd")), "TOKEN_SIGNATURE");
}

TEST_F(TokenVerifierTest, EdDsaIsVerifiedAndNotTakenForAnother) {
  const SigningKey key = SigningKey::ed25519();
  const SigningKey p256 = SigningKey::p256();
  trust(key.public_pem() + p256.public_pem());
  const std::string token = key.token(good_claims());
  EXPECT_EQ(reason(token), "");
  EXPECT_EQ(reason(SigningKey::ed25519().token(good_claims())), "TOKEN_SIGNATURE") << "of a stranger";
  EXPECT_EQ(reason(key.token_with_header(good_claims(), {{"alg", "ES256"}})), "TOKEN_SIGNATURE");
  EXPECT_EQ(reason(p256.token_with_header(good_claims(), {{"alg", "EdDSA"}})), "TOKEN_SIGNATURE");
  EXPECT_EQ(reason(key.token_with_header(good_claims(), {{"alg", "none"}})), "TOKEN_SIGNATURE");
  std::vector<std::string> parts = absl::StrSplit(token, '.');
  parts[1] = base64url(with("tenant", "clinic").dump());
  EXPECT_EQ(reason(parts[0] + "." + parts[1] + "." + parts[2]), "TOKEN_SIGNATURE") << "a changed claim";
  EXPECT_EQ(reason(parts[0] + "." + parts[1] + ".AAAA"), "TOKEN_SIGNATURE");
}

}  // namespace
}  // namespace lipofill::server
