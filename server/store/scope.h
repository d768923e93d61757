#pragma once

#include <optional>
#include <set>
#include <string>

namespace lipofill::server {

/// Tenant that owns everything made without saying who one is.
inline constexpr char kLocalTenant[] = "local";

/// The part of the daemon's data that a caller may see: that of one tenant, and of that perhaps
/// only what belongs to certain patients.
struct Scope {
  std::string tenant = kLocalTenant;
  std::optional<std::set<std::string>> patients = {};  ///< ids; absent: all of the tenant's

  bool has(const std::string& owner, const std::string& patient) const {
    return owner == tenant && (!patients || patients->contains(patient));
  }
};

/// The owner of a resource.
struct Owner {
  std::string tenant;
  std::string patient;  ///< id
};

}  // namespace lipofill::server
