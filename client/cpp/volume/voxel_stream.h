#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::client {

enum class VoxelEncoding {
  kRaw,
  kZlib,   ///< gzip, of any number of members, or zlib
  kBzip2,  ///< of any number of streams
  kHex,    ///< two hexadecimal digits a byte
  kText,   ///< numbers with blanks between them
};

/// The stream says where a volume's voxels lie: in one file or, slice by slice, in several, each
/// with an equal share of the bytes.
struct VoxelStream {
  std::vector<std::filesystem::path> files;
  VoxelEncoding encoding = VoxelEncoding::kRaw;
  uint64_t offset = 0;     ///< bytes of each file before what is encoded
  uint64_t line_skip = 0;  ///< lines to pass over from there
  uint64_t byte_skip = 0;  ///< bytes to pass over behind them, still packed
  /// Bytes to pass over in what is unpacked; below zero the voxels end -1 - skip bytes before its
  /// end, whatever stands before them.
  int64_t skip = 0;
  int vtk_type = 0;  ///< what the numbers of kText become
};

/// Takes a piece of what is unpacked; false: it has enough.
using TakeBytes = std::function<bool(const unsigned char*, size_t)>;

/// Bytes of voxels in one file of the stream, counted up to `enough` in constant memory.
/// INVALID_ARGUMENT, without the file's name, for what cannot be unpacked or is no number.
absl::StatusOr<uint64_t> count_voxel_bytes(const VoxelStream& stream, const std::filesystem::path& file,
                                           uint64_t enough);

/// Gives the first `bytes` bytes of voxels of every file to `take`, piece after piece, in the byte
/// order of the file (that of this machine for kText); fewer where a file has fewer.
absl::Status unpack_voxels(const VoxelStream& stream, uint64_t bytes_per_file, const TakeBytes& take);

}  // namespace lipofill::client
