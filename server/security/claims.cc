#include "server/security/claims.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "server/security/refusals.h"

namespace lipofill::server {
namespace {

using Json = nlohmann::json;
using TimePoint = Principal::Clock::time_point;

constexpr size_t kMostSubject = 256;
constexpr size_t kMostPatients = 256;
constexpr size_t kMostId = 63;
/// Seconds since 1970 that every clock here can hold.
constexpr int64_t kLastTime = int64_t{1} << 33;

absl::Status bad_claim(const std::string& why) {
  return unauthenticated("TOKEN_MALFORMED", absl::StrCat("the token's claim ", why));
}

const Json* find(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

bool is_text(const Json* value, size_t most_bytes) {
  return value != nullptr && value->is_string() && !value->get_ref<const std::string&>().empty() &&
         value->get_ref<const std::string&>().size() <= most_bytes;
}

bool names(const Json* audience, const std::string& expected) {
  if (audience == nullptr) return false;
  if (audience->is_array()) return std::find(audience->begin(), audience->end(), Json(expected)) != audience->end();
  return *audience == expected;
}

/// Reads a time, which is absent or whole seconds since 1970.
absl::StatusOr<std::optional<TimePoint>> read_time(const Json& claims, const char* name) {
  const Json* value = find(claims, name);
  if (value == nullptr) return std::nullopt;
  const int64_t seconds = value->is_number_integer() ? value->get<int64_t>() : -1;
  if (seconds < 0 || seconds > kLastTime) return bad_claim(absl::StrCat(name, " must be whole seconds since 1970"));
  return TimePoint(std::chrono::seconds(seconds));
}

absl::Status check_times(const Json& claims, const ClaimRules& rules, TimePoint now, Principal& principal) {
  const auto expires = read_time(claims, "exp");
  if (!expires.ok()) return expires.status();
  if (!expires->has_value()) return bad_claim("exp is missing: a token must end");
  principal.expires = **expires + rules.clock_skew;
  if (principal.has_expired(now)) return token_expired();
  for (const char* name : {"nbf", "iat"}) {
    const auto from = read_time(claims, name);
    if (!from.ok()) return from.status();
    principal.issued = *from;  // iat, the last, is what stays
    if (from->has_value() && **from > now + rules.clock_skew) {
      return unauthenticated("TOKEN_NOT_YET_VALID", absl::StrCat("the token's claim ", name, " is in the future"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status read_rights(const Json& object, Principal& principal) {
  const Json* tenant = find(object, "tenant");
  if (tenant == nullptr || !tenant->is_string() || !is_tenant(tenant->get<std::string>())) {
    return absl::InvalidArgumentError("tenant must match [a-z][a-z0-9]{0,30}");
  }
  principal.scope.tenant = tenant->get<std::string>();
  const Json* roles = find(object, "roles");
  if (roles == nullptr || !roles->is_array()) {
    return absl::InvalidArgumentError("roles must be a list of viewer, planner and admin");
  }
  principal.role = Role::kNone;
  for (const Json& role : *roles) {
    if (role.is_string()) principal.role = std::max(principal.role, role_of(role.get<std::string>()));
  }
  const Json* patients = find(object, "patients");
  if (patients == nullptr) return absl::OkStatus();
  const bool fits = patients->is_array() && patients->size() <= kMostPatients &&
                    std::all_of(patients->begin(), patients->end(), [](const Json& id) {
                      return is_text(&id, kMostId) && id.get_ref<const std::string&>().find_first_not_of(
                                                          "abcdefghijklmnopqrstuvwxyz0123456789-") == std::string::npos;
                    });
  if (!fits)
    return absl::InvalidArgumentError(absl::StrCat("patients must be a list of at most ", kMostPatients, " ids"));
  principal.scope.patients.emplace();
  for (const Json& id : *patients) principal.scope.patients->insert(id.get<std::string>());
  return absl::OkStatus();
}

absl::StatusOr<Principal> read_claims(const Json& claims, const ClaimRules& rules, TimePoint now) {
  Principal principal;
  const Json* issuer = find(claims, "iss");
  if (issuer == nullptr || *issuer != rules.issuer) {
    return unauthenticated("TOKEN_ISSUER", "the token is not from the issuer that this daemon trusts");
  }
  if (!names(find(claims, "aud"), rules.audience)) {
    return unauthenticated("TOKEN_AUDIENCE", absl::StrCat("the token is not for ", rules.audience));
  }
  if (auto valid = check_times(claims, rules, now, principal); !valid.ok()) return valid;
  const Json* subject = find(claims, "sub");
  if (!is_text(subject, kMostSubject)) return bad_claim(absl::StrCat("sub must have 1 to ", kMostSubject, " bytes"));
  principal.subject = subject->get<std::string>();
  if (const Json* id = find(claims, "jti"); id != nullptr) {
    if (!is_text(id, kMostSubject)) return bad_claim(absl::StrCat("jti must have 1 to ", kMostSubject, " bytes"));
    principal.token_id = id->get<std::string>();
  }
  if (auto rights = read_rights(claims, principal); !rights.ok()) return bad_claim(std::string(rights.message()));
  return principal;
}

}  // namespace lipofill::server
