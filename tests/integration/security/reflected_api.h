#pragma once

#include <set>
#include <string>

#include "tests/integration/security/caller.h"

namespace lipofill::testing {

/// The full names of all methods of all services of the daemon, as it tells them itself, by server
/// reflection; without those of gRPC (health, reflection).
std::set<std::string> reflect_methods(const Caller& caller);

}  // namespace lipofill::testing
