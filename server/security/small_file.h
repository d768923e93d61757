#pragma once

#include <cstdint>
#include <string>
#include <tuple>

#include "absl/status/statusor.h"

namespace lipofill::server {

/// A file of keys or settings, whole. INVALID_ARGUMENT naming it when it cannot be read or has more
/// than 1 MiB.
absl::StatusOr<std::string> read_small_file(const std::string& path);

/// Tells one state of a file from another: where it lies, its size, when it was changed. Zeros
/// where there is none.
using FileStamp = std::tuple<uint64_t, uint64_t, int64_t, int64_t>;
FileStamp stamp_of(const std::string& path);

}  // namespace lipofill::server
