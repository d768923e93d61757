#pragma once

#include <string>

namespace lipofill::server {

/// Lines to standard error, flushed one by one: time in UTC, level, message. Messages name resources by their
/// pseudonymous ids only.
void set_up_logging(const std::string& level);

}  // namespace lipofill::server
