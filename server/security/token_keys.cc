#include "server/security/token_keys.h"

#include <openssl/bn.h>
#include <openssl/core_names.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/param_build.h>
#include <openssl/pem.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace {

using Json = nlohmann::json;

constexpr size_t kMostKeys = 32;
constexpr int kLeastRsaBits = 2048;

template <auto free>
struct Free {
  template <typename T>
  void operator()(T* pointer) const {
    free(pointer);
  }
};
using Bio = std::unique_ptr<BIO, Free<BIO_free_all>>;
using Key = std::unique_ptr<EVP_PKEY, Free<EVP_PKEY_free>>;
using KeyContext = std::unique_ptr<EVP_PKEY_CTX, Free<EVP_PKEY_CTX_free>>;
using Number = std::unique_ptr<BIGNUM, Free<BN_free>>;
using Builder = std::unique_ptr<OSSL_PARAM_BLD, Free<OSSL_PARAM_BLD_free>>;
using Parameters = std::unique_ptr<OSSL_PARAM, Free<OSSL_PARAM_free>>;

absl::Status unusable(const std::string& which, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat(which, " ", why));
}

bool is_algorithm(const std::string& name) {
  return name == "RS256" || name == "ES256" || name == "EdDSA";
}

bool is_on_p256(EVP_PKEY* key) {
  char group[32] = "";
  size_t size = 0;
  return EVP_PKEY_get_group_name(key, group, sizeof group, &size) == 1 && std::string(group, size) == "prime256v1";
}

absl::StatusOr<std::string> algorithm_for(EVP_PKEY* key, const std::string& which) {
  if (EVP_PKEY_is_a(key, "RSA") == 1) {
    if (EVP_PKEY_get_bits(key) >= kLeastRsaBits) return "RS256";
    return unusable(which, absl::StrCat("has ", EVP_PKEY_get_bits(key), " bits, must have at least ", kLeastRsaBits));
  }
  if (EVP_PKEY_is_a(key, "EC") == 1 && is_on_p256(key)) return "ES256";
  if (EVP_PKEY_is_a(key, "ED25519") == 1) return "EdDSA";
  return unusable(which, "is neither an RSA key nor an elliptic one on P-256 or Ed25519");
}

std::string to_pem(EVP_PKEY* key) {
  const Bio memory(BIO_new(BIO_s_mem()));
  PEM_write_bio_PUBKEY(memory.get(), key);
  char* data = nullptr;
  const auto size = BIO_get_mem_data(memory.get(), &data);
  return std::string(data, static_cast<size_t>(size));
}

absl::Status add(EVP_PKEY* key, const std::string& id, const std::string& which, TokenKeys& keys) {
  if (keys.size() == kMostKeys) return unusable(which, absl::StrCat("is one too many, there may be ", kMostKeys));
  auto algorithm = algorithm_for(key, which);
  if (!algorithm.ok()) return algorithm.status();
  keys.push_back({id, *std::move(algorithm), to_pem(key)});
  return absl::OkStatus();
}

absl::StatusOr<TokenKeys> parse_pem(const std::string& text) {
  constexpr char kBegin[] = "-----BEGIN PUBLIC KEY-----";
  TokenKeys keys;
  if (absl::StrContains(text, "PRIVATE KEY")) return unusable("a private key", "does not belong here");
  for (size_t at = text.find(kBegin); at != std::string::npos; at = text.find(kBegin, at + 1)) {
    const std::string which = absl::StrCat("public key ", keys.size() + 1);
    const Bio memory(BIO_new_mem_buf(text.data() + at, static_cast<int>(text.size() - at)));
    const Key key(PEM_read_bio_PUBKEY(memory.get(), nullptr, nullptr, nullptr));
    if (key == nullptr) return unusable(which, "cannot be read");
    if (auto added = add(key.get(), "", which, keys); !added.ok()) return added;
  }
  if (keys.empty()) return absl::InvalidArgumentError("there is no PEM block PUBLIC KEY and no JSON Web Key Set");
  return keys;
}

std::string text_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string bytes_of(const Json& object, const char* name) {
  std::string bytes;
  return absl::WebSafeBase64Unescape(text_of(object, name), &bytes) ? bytes : "";
}

Key make_key(const char* type, OSSL_PARAM_BLD* builder) {
  const Parameters parameters(OSSL_PARAM_BLD_to_param(builder));
  const KeyContext context(EVP_PKEY_CTX_new_from_name(nullptr, type, nullptr));
  EVP_PKEY* key = nullptr;
  if (parameters == nullptr || context == nullptr || EVP_PKEY_fromdata_init(context.get()) != 1) return nullptr;
  EVP_PKEY_fromdata(context.get(), &key, EVP_PKEY_PUBLIC_KEY, parameters.get());
  return Key(key);
}

Number number_of(const std::string& bytes) {
  return Number(
      BN_bin2bn(reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()), nullptr));
}

Key make_rsa_key(const Json& jwk) {
  const Builder builder(OSSL_PARAM_BLD_new());
  const Number modulus = number_of(bytes_of(jwk, "n"));
  const Number exponent = number_of(bytes_of(jwk, "e"));
  OSSL_PARAM_BLD_push_BN(builder.get(), OSSL_PKEY_PARAM_RSA_N, modulus.get());
  OSSL_PARAM_BLD_push_BN(builder.get(), OSSL_PKEY_PARAM_RSA_E, exponent.get());
  return make_key("RSA", builder.get());
}

Key make_elliptic_key(const Json& jwk) {
  constexpr size_t kCoordinate = 32;
  const std::string x = bytes_of(jwk, "x");
  const std::string y = bytes_of(jwk, "y");
  if (text_of(jwk, "crv") != "P-256" || x.size() != kCoordinate || y.size() != kCoordinate) return nullptr;
  const std::string point = absl::StrCat("\x04", x, y);
  const Builder builder(OSSL_PARAM_BLD_new());
  OSSL_PARAM_BLD_push_utf8_string(builder.get(), OSSL_PKEY_PARAM_GROUP_NAME, "prime256v1", 0);
  OSSL_PARAM_BLD_push_octet_string(builder.get(), OSSL_PKEY_PARAM_PUB_KEY, point.data(), point.size());
  return make_key("EC", builder.get());
}

Key make_edwards_key(const Json& jwk) {
  constexpr size_t kPublicKey = 32;
  const std::string x = bytes_of(jwk, "x");
  if (text_of(jwk, "crv") != "Ed25519" || x.size() != kPublicKey) return nullptr;
  return Key(EVP_PKEY_new_raw_public_key(EVP_PKEY_ED25519, nullptr, reinterpret_cast<const unsigned char*>(x.data()),
                                         x.size()));
}

Key make_key_of(const Json& jwk) {
  const std::string type = text_of(jwk, "kty");
  if (type == "RSA") return make_rsa_key(jwk);
  return type == "OKP" ? make_edwards_key(jwk) : make_elliptic_key(jwk);
}

/// A set may hold keys for other uses, which are left out.
bool is_for_signatures(const Json& jwk) {
  const std::string use = text_of(jwk, "use");
  const std::string algorithm = text_of(jwk, "alg");
  return (use.empty() || use == "sig") && (algorithm.empty() || is_algorithm(algorithm));
}

absl::StatusOr<TokenKeys> parse_key_set(const std::string& text) {
  const Json set = Json::parse(text, nullptr, false);
  if (!set.is_object() || !set.contains("keys") || !set["keys"].is_array()) {
    return absl::InvalidArgumentError("is JSON, but no JSON Web Key Set: {\"keys\": [...]}");
  }
  TokenKeys keys;
  for (const Json& jwk : set["keys"]) {
    if (!jwk.is_object() || !is_for_signatures(jwk)) continue;
    const std::string which = absl::StrCat("key \"", absl::CHexEscape(text_of(jwk, "kid")), "\"");
    if (jwk.contains("d") || jwk.contains("k")) return unusable(which, "is a secret one and does not belong here");
    const Key key = make_key_of(jwk);
    if (key == nullptr) return unusable(which, "cannot be read as an RSA key or an elliptic one on P-256 or Ed25519");
    if (auto added = add(key.get(), text_of(jwk, "kid"), which, keys); !added.ok()) return added;
  }
  if (keys.empty()) return absl::InvalidArgumentError("the JSON Web Key Set has no key for RS256, ES256 or EdDSA");
  return keys;
}

}  // namespace

absl::StatusOr<TokenKeys> parse_token_keys(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && text[first] == '{' ? parse_key_set(text) : parse_pem(text);
}

}  // namespace lipofill::server
