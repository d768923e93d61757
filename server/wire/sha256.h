#pragma once

#include <string>
#include <string_view>

#include "core/base/hash.h"

namespace lipofill::server {

/// Hashes the bytes alone; sha256sum prints the same.
inline std::string compute_sha256(std::string_view bytes) {
  Hasher hasher;
  hasher.add_bytes(bytes.data(), bytes.size());
  return hasher.hex_digest();
}

}  // namespace lipofill::server
