#pragma once

#include <optional>
#include <set>
#include <string>

namespace lipofill::server {

/// Whose everything is that was made without saying who one is.
inline constexpr char kLocalTenant[] = "local";

/// What of all that the daemon keeps somebody may see: one tenant's, and of that perhaps only what belongs to certain
/// patients.
struct Scope {
  std::string tenant = kLocalTenant;
  std::optional<std::set<std::string>> patients = {};  ///< ids; absent: all of the tenant's

  bool has(const std::string& owner, const std::string& patient) const {
    return owner == tenant && (!patients || patients->contains(patient));
  }
};

/// Whose something is.
struct Owner {
  std::string tenant;
  std::string patient;  ///< id
};

}  // namespace lipofill::server
