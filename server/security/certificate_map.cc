#include "server/security/certificate_map.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "server/security/claims.h"

namespace lipofill::server {
namespace {

using Json = nlohmann::json;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// A member that nobody reads is a mistake: perhaps a limit that would not hold.
absl::Status check_members(const Json& object) {
  constexpr const char* kKnown[] = {"common_name", "alternative_name", "tenant", "roles", "patients"};
  for (const auto& [name, value] : object.items()) {
    if (std::find(std::begin(kKnown), std::end(kKnown), name) == std::end(kKnown)) {
      return absl::InvalidArgumentError(absl::StrCat("has the unknown member \"", name, "\""));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<CertificateEntry> parse_entry(const Json& object) {
  if (!object.is_object()) return absl::InvalidArgumentError("must be an object");
  if (auto known = check_members(object); !known.ok()) return known;
  if (object.contains("common_name") == object.contains("alternative_name")) {
    return absl::InvalidArgumentError("must have either a common_name or an alternative_name");
  }
  CertificateEntry entry;
  entry.is_alternative = object.contains("alternative_name");
  const Json& name = object[entry.is_alternative ? "alternative_name" : "common_name"];
  if (!name.is_string() || name.get_ref<const std::string&>().empty()) {
    return absl::InvalidArgumentError("must have a name that is a text");
  }
  entry.name = name.get<std::string>();
  entry.principal.subject = entry.name;
  if (auto rights = read_rights(object, entry.principal); !rights.ok()) return rights;
  if (entry.principal.role == Role::kNone) {
    return absl::InvalidArgumentError("roles must have one of viewer, planner and admin");
  }
  return entry;
}

}  // namespace

absl::StatusOr<CertificateMap> CertificateMap::parse(const std::string& text) {
  const Json file = Json::parse(text, nullptr, false);
  if (!file.is_object() || !file.contains("certificates") || !file["certificates"].is_array()) {
    return absl::InvalidArgumentError("must be JSON, {\"certificates\": [...]}");
  }
  CertificateMap map;
  for (const Json& object : file["certificates"]) {
    auto entry = parse_entry(object);
    if (!entry.ok()) {
      return absl::InvalidArgumentError(
          absl::StrCat("certificates[", map.entries_.size(), "]: ", std::string(entry.status().message())));
    }
    map.entries_.push_back(*std::move(entry));
  }
  return map;
}

const Principal* CertificateMap::find(const std::vector<std::string>& common_names,
                                      const std::vector<std::string>& alternative_names) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const CertificateEntry& entry) {
    return contains(entry.is_alternative ? alternative_names : common_names, entry.name);
  });
  return found == entries_.end() ? nullptr : &found->principal;
}

}  // namespace lipofill::server
