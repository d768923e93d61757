#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"

struct evp_pkey_st;

namespace lipofill::server {

/// The key that the audit log's anchor is signed with: Ed25519, RSA or elliptic, from a PEM file
/// with a private key or, to verify only, a public one. Thread-safe. Checked by
/// tests/unit/server/security/audit_anchor_test.cc.
class AnchorKey {
 public:
  /// Opens the private key. INVALID_ARGUMENT naming the file and what is wrong with it.
  static absl::StatusOr<AnchorKey> open(const std::string& path);
  /// Opens either, to verify.
  static absl::StatusOr<AnchorKey> open_to_verify(const std::string& path);

  /// A signature, in base64.
  std::string sign(const std::string& text) const;
  bool has_signed(const std::string& text, const std::string& signature) const;

 private:
  explicit AnchorKey(std::shared_ptr<evp_pkey_st> key) : key_(std::move(key)) {}

  std::shared_ptr<evp_pkey_st> key_;
};

}  // namespace lipofill::server
