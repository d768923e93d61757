#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "server/store/scope.h"

namespace lipofill::server {

/// The rights of a caller. Each role may do everything that those before it may.
enum class Role {
  kNone,     ///< is known, and may do nothing
  kViewer,   ///< looks
  kPlanner,  ///< changes: patients, scans, models, simulations
  kAdmin,    ///< deletes patients and all that is theirs
};

const char* role_name(Role role);
/// Returns kNone for a word that is no role.
Role role_of(const std::string& word);

/// A tenant's name: a lower-case letter, then up to 30 of a-z and 0-9. Without '-', so that an id
/// that begins with "{tenant}-" is one tenant's alone.
bool is_tenant(const std::string& text);

/// The caller. By default it is the user of this machine, to whom a daemon without authentication
/// belongs.
struct Principal {
  using Clock = std::chrono::system_clock;

  std::string subject = "local";
  Role role = Role::kAdmin;
  Scope scope;
  std::optional<Clock::time_point> expires = {};  ///< the token ends then, the clock's tolerance included
  std::optional<Clock::time_point> issued = {};   ///< the token was issued then, where it says so
  std::string token_id = {};                      ///< "jti" of the token; empty without one

  bool has_expired(Clock::time_point now = Clock::now()) const { return expires && now >= *expires; }
};

}  // namespace lipofill::server
