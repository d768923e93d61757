#pragma once

#include <cstdint>
#include <filesystem>

#include "absl/status/status.h"
#include "client/cpp/volume/voxel_stream.h"

namespace lipofill::client {

// Each gives what a file holds from an offset on to `take`, piece after piece in constant memory,
// until it ends, is damaged, or `take` has enough and returns false. INVALID_ARGUMENT, without the
// file's name, for what is not encoded so. Checked by tests/unit/client/volume_kinds_test.cc.

/// The bytes as they are.
absl::Status copy_bytes(const std::filesystem::path& file, uint64_t offset, const TakeBytes& take);

/// Unpacks gzip or zlib. A gzip file may have any number of members (RFC 1952, section 2.2); what
/// follows the last one is not looked at.
absl::Status unpack_zlib(const std::filesystem::path& file, uint64_t offset, const TakeBytes& take);

/// Unpacks bzip2, by libarchive.
absl::Status unpack_bzip2(const std::filesystem::path& file, uint64_t offset, const TakeBytes& take);

/// Turns pairs of hexadecimal digits into bytes, with any blanks between them.
absl::Status unpack_hex(const std::filesystem::path& file, uint64_t offset, const TakeBytes& take);

/// Turns numbers with blanks or commas between them into values of a VTK type, in the byte order of
/// this machine. A number that the type cannot hold is refused.
absl::Status unpack_text(const std::filesystem::path& file, uint64_t offset, int vtk_type, const TakeBytes& take);

}  // namespace lipofill::client
