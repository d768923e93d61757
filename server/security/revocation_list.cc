#include "server/security/revocation_list.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace {

using Json = nlohmann::json;

constexpr int64_t kLastTime = int64_t{1} << 33;

/// A member that nobody reads is a mistake: what it was to revoke would not be.
absl::Status check_members(const Json& entry) {
  constexpr const char* kKnown[] = {"token_id", "tenant", "subject", "issued_before"};
  if (!entry.is_object()) return absl::InvalidArgumentError("must be an object");
  for (const auto& [name, value] : entry.items()) {
    if (std::find(std::begin(kKnown), std::end(kKnown), name) == std::end(kKnown)) {
      return absl::InvalidArgumentError(absl::StrCat("has the unknown member \"", name, "\""));
    }
    const bool fits = name == "issued_before" ? value.is_number_integer() && value >= 0 && value <= kLastTime
                                              : value.is_string() && !value.get_ref<const std::string&>().empty();
    if (!fits) return absl::InvalidArgumentError(absl::StrCat(name, " is ", value.dump(), ", which it cannot be"));
  }
  const bool is_token = entry.contains("token_id") && entry.size() == 1;
  const bool is_subject = entry.contains("tenant") && entry.contains("subject") && !entry.contains("token_id");
  if (is_token || is_subject) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "must have token_id alone, or tenant and subject, with issued_before where that is meant");
}

}  // namespace

absl::StatusOr<RevocationList> RevocationList::parse(const std::string& text) {
  const Json file = Json::parse(text, nullptr, false);
  if (!file.is_object() || file.size() != 1 || !file.contains("revoked") || !file["revoked"].is_array()) {
    return absl::InvalidArgumentError("must be JSON, {\"revoked\": [...]}");
  }
  RevocationList list;
  size_t number = 0;
  for (const Json& entry : file["revoked"]) {
    if (auto valid = check_members(entry); !valid.ok()) {
      return absl::InvalidArgumentError(absl::StrCat("revoked[", number, "]: ", std::string(valid.message())));
    }
    ++number;
    if (entry.contains("token_id")) {
      list.token_ids_.insert(entry["token_id"].get<std::string>());
      continue;
    }
    const Subject subject(entry["tenant"].get<std::string>(), entry["subject"].get<std::string>());
    std::optional<Principal::Clock::time_point> until;
    if (entry.contains("issued_before")) {
      until = Principal::Clock::time_point(std::chrono::seconds(entry["issued_before"].get<int64_t>()));
    }
    const auto [known, is_new] = list.subjects_.emplace(subject, until);
    // Of two entries the one that revokes more holds.
    if (!is_new && known->second) known->second = until ? std::max(*known->second, *until) : until;
  }
  return list;
}

bool RevocationList::has(const Principal& principal) const {
  if (!principal.token_id.empty() && token_ids_.contains(principal.token_id)) return true;
  const auto found = subjects_.find({principal.scope.tenant, principal.subject});
  if (found == subjects_.end()) return false;
  // What does not say when it was issued may have been before.
  return !found->second || !principal.issued || *principal.issued < *found->second;
}

}  // namespace lipofill::server
