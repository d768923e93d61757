#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "server/security/principal.h"

namespace lipofill::server {

/// Tokens and callers that are no longer good, before their tokens end. Checked by
/// tests/unit/server/security/revocation_list_test.cc.
class RevocationList {
 public:
  /// JSON: {"revoked": [{"token_id": "8f3a"}, {"tenant": "ward", "subject": "dr-grey"},
  /// {"tenant": "ward", "subject": "dr-shepherd", "issued_before": 1767225600}]}: a token by its
  /// claim jti; all that a subject holds, client certificates too; those of its tokens that were
  /// issued (iat) before a time, in seconds since 1970. INVALID_ARGUMENT naming the entry and what
  /// is wrong with it.
  static absl::StatusOr<RevocationList> parse(const std::string& text);

  bool has(const Principal& principal) const;

 private:
  using Subject = std::pair<std::string, std::string>;  ///< tenant, subject

  std::set<std::string> token_ids_;
  /// Until when what was issued is revoked; without a time, whenever it was.
  std::map<Subject, std::optional<Principal::Clock::time_point>> subjects_;
};

}  // namespace lipofill::server
