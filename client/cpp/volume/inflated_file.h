#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>

namespace lipofill::client {

/// Unpacks the gzip or zlib stream that begins at an offset of a file, in constant memory, until it
/// ends, is damaged, or `take`, which is given piece after piece, has enough and returns false.
/// Checked by tests/unit/client/volume_test.cc.
void inflate_file(const std::filesystem::path& file, uint64_t offset,
                  const std::function<bool(const unsigned char*, size_t)>& take);

}  // namespace lipofill::client
