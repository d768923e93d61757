#pragma once

#include <memory>
#include <string>

#include "nlohmann/json.hpp"

struct evp_pkey_st;

namespace lipofill::testing {

/// A key made for the test, and the tokens it signs. Made with OpenSSL alone, not with the library
/// that verifies them.
class SigningKey {
 public:
  static SigningKey rsa(unsigned int bits = 2048);
  static SigningKey p256();
  static SigningKey p384();
  static SigningKey ed25519();

  std::string public_pem() const;
  std::string private_pem() const;
  /// As an entry of a JSON Web Key Set.
  nlohmann::json jwk(const std::string& id) const;
  /// The signature as a token has it: of an elliptic key r and s one after the other.
  std::string sign(const std::string& text) const;
  /// A token with "alg" as it is right for the key and, where it is not empty, "kid".
  std::string token(const nlohmann::json& claims, const std::string& id = "") const;
  std::string token_with_header(const nlohmann::json& claims, const nlohmann::json& header) const;

 private:
  explicit SigningKey(evp_pkey_st* key);
  bool is_rsa() const;
  bool is_edwards() const;
  std::string number(const char* name) const;

  std::shared_ptr<evp_pkey_st> key_;
};

std::string base64url(const std::string& bytes);

/// Claims of a planner of the tenant "ward" that are good for an hour from now.
nlohmann::json good_claims();

}  // namespace lipofill::testing
