#pragma once

#include <cstdint>
#include <string>

namespace lipofill::server {

/// Makes an id for a resource whose maker gave none: `prefix` and 16 random hexadecimal digits.
std::string make_id(char prefix);

/// Microseconds since 1970.
int64_t now_us();

}  // namespace lipofill::server
