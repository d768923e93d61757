#include "client/cpp/volume/voxel_stream.h"

#include <algorithm>
#include <fstream>
#include <optional>

#include "absl/strings/str_cat.h"
#include "client/cpp/volume/unpacking.h"

namespace lipofill::client {
namespace {

constexpr uint64_t kSumWithin = uint64_t{1} << 20;

/// The offset behind `lines` line ends, or none where the file has fewer.
std::optional<uint64_t> offset_behind_lines(const std::filesystem::path& file, uint64_t offset, uint64_t lines) {
  if (lines == 0) return offset;
  uint64_t position = offset;
  (void)copy_bytes(file, offset, [&](const unsigned char* piece, size_t size) {
    for (size_t k = 0; k < size && lines > 0; ++k, ++position) lines -= piece[k] == '\n' ? 1 : 0;
    return lines > 0;
  });
  return lines == 0 ? std::optional(position) : std::nullopt;
}

/// Everything that one file unpacks to, the bytes to pass over among it.
absl::Status unpack_all(const VoxelStream& stream, const std::filesystem::path& file, const TakeBytes& take) {
  const auto lines_end = offset_behind_lines(file, stream.offset, stream.line_skip);
  if (!lines_end)
    return absl::InvalidArgumentError(absl::StrCat("has fewer lines than the ", stream.line_skip, " of its line skip"));
  const uint64_t offset = *lines_end + stream.byte_skip;
  switch (stream.encoding) {
    case VoxelEncoding::kRaw:
      return copy_bytes(file, offset, take);
    case VoxelEncoding::kZlib:
      return unpack_zlib(file, offset, take);
    case VoxelEncoding::kBzip2:
      return unpack_bzip2(file, offset, take);
    case VoxelEncoding::kHex:
      return unpack_hex(file, offset, take);
    case VoxelEncoding::kText:
      return unpack_text(file, offset, stream.vtk_type, take);
  }
  return absl::InternalError("no such encoding");
}

absl::StatusOr<uint64_t> count_all(const VoxelStream& stream, const std::filesystem::path& file, uint64_t enough) {
  if (stream.encoding == VoxelEncoding::kRaw && stream.line_skip == 0) {
    std::error_code error;
    const uint64_t bytes = std::filesystem::file_size(file, error);
    return error || bytes < stream.offset ? 0 : bytes - stream.offset;
  }
  uint64_t count = 0;
  // Behind the last byte stands the sum that tells damaged ones: read on to it, where it is near.
  const absl::Status status = unpack_all(
      stream, file, [&](const unsigned char*, size_t bytes) { return (count += bytes) <= enough + kSumWithin; });
  if (!status.ok()) return status;
  return count;
}

}  // namespace

absl::StatusOr<uint64_t> count_voxel_bytes(const VoxelStream& stream, const std::filesystem::path& file,
                                           uint64_t enough) {
  const bool from_end = stream.skip < 0;
  const uint64_t other = from_end ? static_cast<uint64_t>(-1 - stream.skip) : static_cast<uint64_t>(stream.skip);
  const auto all = count_all(stream, file, enough + other);
  if (!all.ok()) return all.status();
  return *all > other ? *all - other : 0;
}

absl::Status unpack_voxels(const VoxelStream& stream, uint64_t bytes_per_file, const TakeBytes& take) {
  bool wants_more = true;
  for (const std::filesystem::path& file : stream.files) {
    uint64_t skip = static_cast<uint64_t>(std::max<int64_t>(stream.skip, 0));
    if (stream.skip < 0) {
      const auto all = count_all(stream, file, UINT64_MAX);
      if (!all.ok()) return all.status();
      const uint64_t behind = bytes_per_file + static_cast<uint64_t>(-1 - stream.skip);
      skip = *all > behind ? *all - behind : 0;
    }
    uint64_t left = bytes_per_file;
    const absl::Status status = unpack_all(stream, file, [&](const unsigned char* piece, size_t size) {
      const auto passed = static_cast<size_t>(std::min<uint64_t>(skip, size));
      skip -= passed;
      const auto count = static_cast<size_t>(std::min<uint64_t>(left, size - passed));
      left -= count;
      if (count > 0) wants_more = take(piece + passed, count);
      return wants_more && left > 0;
    });
    if (!status.ok()) return status;
    if (!wants_more) break;
  }
  return absl::OkStatus();
}

}  // namespace lipofill::client
