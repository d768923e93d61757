#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/owned_files.h"

namespace lipofill::server {

/// The bytes of uploaded scans, a file each: <root>/<patient>/<scan>. Ids are checked by whoever
/// calls: they hold no separators. Checked by tests/unit/server/store/scan_files_test.cc.
class ScanFiles {
 public:
  static absl::StatusOr<ScanFiles> open(const std::filesystem::path& root);

  /// Bytes on disk, 0 where there is no file.
  uint64_t size(const std::string& patient, const std::string& scan) const;
  /// When bytes were last written [us since 1970]; 0 where there is no file.
  int64_t last_write_us(const std::string& patient, const std::string& scan) const;
  /// Writes at an offset, making the file where there is none. RESOURCE_EXHAUSTED when the disk is
  /// full.
  absl::Status write(const std::string& patient, const std::string& scan, uint64_t offset,
                     std::string_view bytes) const;
  /// Waits until all that was written to a scan is on the medium.
  absl::Status flush(const std::string& patient, const std::string& scan) const;
  /// Reads what there is of a scan. DATA_LOSS without a file, UNAVAILABLE when it cannot be read at
  /// this moment.
  absl::StatusOr<std::string> read(const std::string& patient, const std::string& scan) const;
  /// Reads a scan that is complete. DATA_LOSS also when the file is not the one with this hash,
  /// which was uploaded.
  absl::StatusOr<std::string> read_whole(const std::string& patient, const std::string& scan,
                                         const std::string& sha256) const;
  void remove(const std::string& patient, const std::string& scan) const { files_.remove(patient, scan); }
  const OwnedFiles& files() const { return files_; }

 private:
  explicit ScanFiles(OwnedFiles files) : files_(std::move(files)) {}
  OwnedFiles files_;
};

}  // namespace lipofill::server
