#include "server/security/token_keys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/security/key_fixture.h"

namespace lipofill::server {
namespace {

using lipofill::testing::SigningKey;
using ::testing::HasSubstr;
using Json = nlohmann::json;

std::string refusal(const std::string& text) {
  const auto keys = parse_token_keys(text);
  EXPECT_TRUE(keys.ok() || absl::IsInvalidArgument(keys.status()));
  return keys.ok() ? "" : std::string(keys.status().message());
}

TEST(TokenKeys, AreReadFromPem) {
  const SigningKey rsa = SigningKey::rsa();
  const SigningKey p256 = SigningKey::p256();
  const auto keys = parse_token_keys("the old one\n" + rsa.public_pem() + "\nthe new one\n" + p256.public_pem());
  ASSERT_TRUE(keys.ok()) << keys.status();
  ASSERT_EQ(keys->size(), 2u);
  EXPECT_EQ((*keys)[0].algorithm, "RS256");
  EXPECT_EQ((*keys)[0].pem, rsa.public_pem());
  EXPECT_EQ((*keys)[1].algorithm, "ES256");
  EXPECT_EQ((*keys)[1].pem, p256.public_pem());
}

TEST(TokenKeys, AreReadFromAKeySet) {
  const SigningKey rsa = SigningKey::rsa();
  const SigningKey p256 = SigningKey::p256();
  Json for_encryption = rsa.jwk("e");
  for_encryption["use"] = "enc";
  const auto keys = parse_token_keys(Json{{"keys", {for_encryption, rsa.jwk("a"), p256.jwk("b")}}}.dump(2));
  ASSERT_TRUE(keys.ok()) << keys.status();
  ASSERT_EQ(keys->size(), 2u) << "the one for encryption is of no use here";
  EXPECT_EQ((*keys)[0].id, "a");
  EXPECT_EQ((*keys)[0].pem, rsa.public_pem());
  EXPECT_EQ((*keys)[1].id, "b");
  EXPECT_EQ((*keys)[1].pem, p256.public_pem());
}

TEST(TokenKeys, MayBeOfEdwards) {
  const SigningKey key = SigningKey::ed25519();
  const auto pem = parse_token_keys(key.public_pem());
  ASSERT_TRUE(pem.ok()) << pem.status();
  EXPECT_EQ((*pem)[0].algorithm, "EdDSA");
  const auto set = parse_token_keys(Json{{"keys", {key.jwk("e")}}}.dump());
  ASSERT_TRUE(set.ok()) << set.status();
  EXPECT_EQ((*set)[0].pem, key.public_pem());
  Json other_curve = key.jwk("o");
  other_curve["crv"] = "Ed448";
  EXPECT_THAT(refusal(Json{{"keys", {other_curve}}}.dump()), HasSubstr("key \"o\" cannot be read"));
  Json short_key = key.jwk("s");
  short_key["x"] = "AAAA";
  EXPECT_THAT(refusal(Json{{"keys", {short_key}}}.dump()), HasSubstr("key \"s\" cannot be read"));
}

TEST(TokenKeys, AreNotSecretNotWeakAndNotOnOtherCurves) {
  EXPECT_THAT(refusal(SigningKey::rsa().private_pem()), HasSubstr("private key"));
  EXPECT_THAT(refusal(SigningKey::rsa(1024).public_pem()), HasSubstr("has 1024 bits, must have at least 2048"));
  EXPECT_THAT(refusal(SigningKey::p384().public_pem()), HasSubstr("on P-256"));
  Json secret = SigningKey::p256().jwk("s");
  secret["d"] = "AAAA";
  EXPECT_THAT(refusal(Json{{"keys", {secret}}}.dump()), HasSubstr("key \"s\" is a secret one"));
  EXPECT_THAT(refusal(R"({"keys":[{"kty":"oct","k":"c2VjcmV0","kid":"h"}]})"), HasSubstr("is a secret one"));
}

TEST(TokenKeys, WhatCannotBeReadIsSaid) {
  EXPECT_THAT(refusal(""), HasSubstr("no PEM block"));
  EXPECT_THAT(refusal("-----BEGIN PUBLIC KEY-----\nAAAA\n-----END PUBLIC KEY-----\n"),
              HasSubstr("public key 1 cannot"));
  EXPECT_THAT(refusal("{"), HasSubstr("no JSON Web Key Set"));
  EXPECT_THAT(refusal(R"({"keys": {}})"), HasSubstr("no JSON Web Key Set"));
  EXPECT_THAT(refusal(R"({"keys": [1, {"kty": "RSA", "alg": "PS256"}]})"),
              HasSubstr("has no key for RS256, ES256 or EdDSA"));
  EXPECT_THAT(refusal(R"({"keys": [{"kty": "RSA"}]})"), HasSubstr("key \"\""));
  EXPECT_THAT(refusal(R"({"keys": [{"kty": "EC", "crv": "P-256", "x": "AA", "y": "AA"}]})"),
              HasSubstr("cannot be read"));
  Json off_curve = SigningKey::p256().jwk("b");
  off_curve["x"] = lipofill::testing::base64url(std::string(32, '\1'));
  EXPECT_THAT(refusal(Json{{"keys", {off_curve}}}.dump()), HasSubstr("key \"b\" cannot be read"));
  std::string many;
  const std::string pem = SigningKey::p256().public_pem();
  for (int i = 0; i < 33; ++i) many += pem;
  EXPECT_THAT(refusal(many), HasSubstr("one too many"));
}

}  // namespace
}  // namespace lipofill::server
