#include "tests/unit/server/security/key_fixture.h"

#include <openssl/bn.h>
#include <openssl/core_names.h>
#include <openssl/ec.h>
#include <openssl/ecdsa.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>

#include <ctime>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace lipofill::testing {
namespace {

using Json = nlohmann::json;

std::string drain(BIO* memory) {
  char* data = nullptr;
  const auto size = BIO_get_mem_data(memory, &data);
  std::string text(data, static_cast<size_t>(size));
  BIO_free_all(memory);
  return text;
}

std::string bytes_of(const BIGNUM* number, int size) {
  std::string bytes(static_cast<size_t>(size), '\0');
  BN_bn2binpad(number, reinterpret_cast<unsigned char*>(bytes.data()), size);
  return bytes;
}

std::string to_plain_signature(const std::string& der) {
  const auto* at = reinterpret_cast<const unsigned char*>(der.data());
  ECDSA_SIG* signature = d2i_ECDSA_SIG(nullptr, &at, static_cast<long>(der.size()));
  const std::string plain = bytes_of(ECDSA_SIG_get0_r(signature), 32) + bytes_of(ECDSA_SIG_get0_s(signature), 32);
  ECDSA_SIG_free(signature);
  return plain;
}

}  // namespace

std::string base64url(const std::string& bytes) {
  return absl::WebSafeBase64Escape(bytes);
}

SigningKey::SigningKey(evp_pkey_st* key) : key_(key, EVP_PKEY_free) {}

SigningKey SigningKey::rsa(unsigned int bits) {
  return SigningKey(EVP_RSA_gen(bits));
}
SigningKey SigningKey::p256() {
  return SigningKey(EVP_EC_gen("P-256"));
}
SigningKey SigningKey::p384() {
  return SigningKey(EVP_EC_gen("P-384"));
}

SigningKey SigningKey::ed25519() {
  return SigningKey(EVP_PKEY_Q_keygen(nullptr, nullptr, "ED25519"));
}

bool SigningKey::is_edwards() const {
  return EVP_PKEY_is_a(key_.get(), "ED25519") == 1;
}

bool SigningKey::is_rsa() const {
  return EVP_PKEY_is_a(key_.get(), "RSA") == 1;
}

std::string SigningKey::public_pem() const {
  BIO* memory = BIO_new(BIO_s_mem());
  PEM_write_bio_PUBKEY(memory, key_.get());
  return drain(memory);
}

std::string SigningKey::private_pem() const {
  BIO* memory = BIO_new(BIO_s_mem());
  PEM_write_bio_PrivateKey(memory, key_.get(), nullptr, nullptr, 0, nullptr, nullptr);
  return drain(memory);
}

std::string SigningKey::number(const char* name) const {
  BIGNUM* number = nullptr;
  EVP_PKEY_get_bn_param(key_.get(), name, &number);
  const std::string bytes = bytes_of(number, is_rsa() ? BN_num_bytes(number) : 32);
  BN_free(number);
  return base64url(bytes);
}

Json SigningKey::jwk(const std::string& id) const {
  if (is_edwards()) {
    std::string x(32, '\0');
    size_t size = x.size();
    EVP_PKEY_get_raw_public_key(key_.get(), reinterpret_cast<unsigned char*>(x.data()), &size);
    return {{"kty", "OKP"}, {"crv", "Ed25519"}, {"kid", id}, {"x", base64url(x)}};
  }
  if (is_rsa()) {
    return {{"kty", "RSA"}, {"kid", id}, {"n", number(OSSL_PKEY_PARAM_RSA_N)}, {"e", number(OSSL_PKEY_PARAM_RSA_E)}};
  }
  return {{"kty", "EC"},
          {"crv", "P-256"},
          {"kid", id},
          {"use", "sig"},
          {"x", number(OSSL_PKEY_PARAM_EC_PUB_X)},
          {"y", number(OSSL_PKEY_PARAM_EC_PUB_Y)}};
}

std::string SigningKey::sign(const std::string& text) const {
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  const auto* data = reinterpret_cast<const unsigned char*>(text.data());
  size_t size = 0;
  EVP_DigestSignInit(context, nullptr, is_edwards() ? nullptr : EVP_sha256(), nullptr, key_.get());
  EVP_DigestSign(context, nullptr, &size, data, text.size());
  std::string signature(size, '\0');
  EVP_DigestSign(context, reinterpret_cast<unsigned char*>(signature.data()), &size, data, text.size());
  EVP_MD_CTX_free(context);
  signature.resize(size);
  return is_rsa() || is_edwards() ? signature : to_plain_signature(signature);
}

std::string SigningKey::token(const Json& claims, const std::string& id) const {
  Json header = {{"alg", is_rsa() ? "RS256" : is_edwards() ? "EdDSA" : "ES256"}, {"typ", "JWT"}};
  if (!id.empty()) header["kid"] = id;
  return token_with_header(claims, header);
}

std::string SigningKey::token_with_header(const Json& claims, const Json& header) const {
  const std::string text = absl::StrCat(base64url(header.dump()), ".", base64url(claims.dump()));
  return absl::StrCat(text, ".", base64url(sign(text)));
}

Json good_claims() {
  const auto now = static_cast<int64_t>(std::time(nullptr));
  return {{"iss", "https://id.example"}, {"aud", "lipofill"}, {"sub", "dr-grey"}, {"tenant", "ward"},
          {"roles", {"planner"}},        {"iat", now},        {"exp", now + 3600}};
}

}  // namespace lipofill::testing
