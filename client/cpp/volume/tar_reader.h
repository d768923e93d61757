#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

struct gzFile_s;

namespace lipofill::client {

/// One file inside a tar.
struct TarEntry {
  std::string name;
  uint64_t size = 0;
};

/// Reads a tar, gzipped or not, from front to back in constant memory.
class TarReader {
 public:
  static absl::StatusOr<TarReader> open(const std::filesystem::path& file);

  /// Goes to the next file whose name ends in `suffix`. NOT_FOUND when there is none;
  /// INVALID_ARGUMENT for what is no tar.
  absl::StatusOr<TarEntry> find(const std::string& suffix);

  /// The next bytes of the file found. INVALID_ARGUMENT where the tar ends before.
  absl::Status read(char* data, size_t size);

 private:
  struct Close {
    void operator()(gzFile_s* stream) const;
  };
  std::unique_ptr<gzFile_s, Close> stream_;
  uint64_t position_ = 0;  // counts in the unpacked tar
  uint64_t next_ = 0;      // where the next header is
  std::string file_;
};

}  // namespace lipofill::client
