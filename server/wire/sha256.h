#pragma once

#include <string>
#include <string_view>

#include "core/base/hash.h"

namespace lipofill::server {

/// Of the bytes alone, as sha256sum prints it.
inline std::string compute_sha256(std::string_view bytes) {
  Hasher hasher;
  hasher.add_bytes(bytes.data(), bytes.size());
  return hasher.hex_digest();
}

}  // namespace lipofill::server
