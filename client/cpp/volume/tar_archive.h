#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

struct archive;

namespace lipofill::client {

/// Reads the files in a tar, gzipped or not, from front to back in constant memory; by libarchive,
/// of which it lets in these two formats alone. Checked by tests/unit/client/invesalius_test.cc and
/// tests/fuzz/volume_fuzzer.cc.
class TarArchive {
 public:
  /// Bytes that the files of an archive may claim to hold when unpacked, in all: a few kilobytes
  /// can claim any number.
  static constexpr uint64_t kMaxUnpackedBytes = uint64_t{16} << 30;

  /// INVALID_ARGUMENT for what is no file.
  static absl::StatusOr<TarArchive> open(const std::filesystem::path& file);

  /// Goes to the next file whose name ends in `suffix`, and returns how many bytes it claims to
  /// hold. NOT_FOUND when there is none; INVALID_ARGUMENT for what is no tar, is cut short or
  /// damaged, or claims more than kMaxUnpackedBytes on the way.
  absl::StatusOr<uint64_t> find(const std::string& suffix);

  /// The next bytes of the file found. INVALID_ARGUMENT where it, or the archive, ends before.
  absl::Status read(char* data, size_t size);

 private:
  struct Close {
    void operator()(archive* stream) const;
  };
  absl::Status explain(const char* otherwise) const;

  std::unique_ptr<archive, Close> stream_;
  uint64_t claimed_bytes_ = 0;  ///< by the files passed so far
  std::string file_;
};

}  // namespace lipofill::client
