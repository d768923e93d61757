#include "server/security/token_signature.h"

#include <openssl/evp.h>
#include <openssl/pem.h>

#include <jwt/jwt.hpp>
#include <memory>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "server/security/refusals.h"

namespace lipofill::server {
namespace {

using Json = nlohmann::json;

constexpr size_t kMostBytes = 8192;
constexpr char kBase64Url[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

absl::Status malformed(const std::string& why) {
  return unauthenticated("TOKEN_MALFORMED", absl::StrCat("the token ", why));
}

Json parse_part(const std::string& part) {
  std::string bytes;
  if (!absl::WebSafeBase64Unescape(part, &bytes)) return {};
  Json object = Json::parse(bytes, nullptr, false);
  return object.is_object() ? object : Json();
}

std::string text_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace

absl::StatusOr<TokenParts> take_token_apart(const std::string& token) {
  if (token.size() > kMostBytes) {
    return malformed(absl::StrCat("has ", token.size(), " bytes, may have at most ", kMostBytes));
  }
  const std::vector<std::string> parts = absl::StrSplit(token, '.');
  if (parts.size() != 3) return malformed("is no signed JSON Web Token: it must have three parts");
  for (const std::string& part : parts) {
    if (part.empty() || part.find_first_not_of(kBase64Url) != std::string::npos) {
      return malformed("is no signed JSON Web Token: its parts must be base64url");
    }
  }
  TokenParts taken{parse_part(parts[0]), parse_part(parts[1]), "", ""};
  if (taken.header.is_null() || taken.claims.is_null()) return malformed("has no header or no claims");
  if (taken.header.contains("crit")) return malformed("has extensions that are not understood");
  taken.key_id = text_of(taken.header, "kid");
  taken.algorithm = text_of(taken.header, "alg");
  if (taken.algorithm.empty()) return malformed("names no algorithm");
  return taken;
}

namespace {

/// The library does not know EdDSA. Ed25519 signs the text itself, not a hash of it (RFC 8032).
bool is_signed_by_edwards(const std::string& token, const TokenKey& key) {
  const size_t last_dot = token.rfind('.');
  std::string signature;
  if (!absl::WebSafeBase64Unescape(token.substr(last_dot + 1), &signature)) return false;
  const std::unique_ptr<BIO, decltype(&BIO_free_all)> pem(
      BIO_new_mem_buf(key.pem.data(), static_cast<int>(key.pem.size())), &BIO_free_all);
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> read(
      PEM_read_bio_PUBKEY(pem.get(), nullptr, nullptr, nullptr), &EVP_PKEY_free);
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  const auto* bytes = reinterpret_cast<const unsigned char*>(signature.data());
  const auto* text = reinterpret_cast<const unsigned char*>(token.data());
  return read != nullptr && EVP_DigestVerifyInit(context.get(), nullptr, nullptr, nullptr, read.get()) == 1 &&
         EVP_DigestVerify(context.get(), bytes, signature.size(), text, last_dot) == 1;
}

}  // namespace

// Only the signatures of the library are used: the claims are checked elsewhere.
bool is_signed_by(const std::string& token, const TokenKey& key) {
  if (key.algorithm == "EdDSA") return is_signed_by_edwards(token, key);
  try {
    const size_t last_dot = token.rfind('.');
    const jwt::jwt_header header(jwt::str_to_alg(key.algorithm));
    jwt::jwt_signature signature(key.pem);
    const auto [is_good, error] = signature.verify(header, token.substr(0, last_dot), token.substr(last_dot + 1));
    return is_good && !error;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace lipofill::server
