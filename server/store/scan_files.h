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
  /// Writes at an offset, making the file where there is none. RESOURCE_EXHAUSTED when the disk is
  /// full.
  absl::Status write(const std::string& patient, const std::string& scan, uint64_t offset,
                     std::string_view bytes) const;
  /// Waits until all that was written to a scan is on the medium.
  absl::Status flush(const std::string& patient, const std::string& scan) const;
  absl::StatusOr<std::string> read(const std::string& patient, const std::string& scan) const;
  void remove(const std::string& patient, const std::string& scan) const { files_.remove(patient, scan); }
  void remove_patient(const std::string& patient) const { files_.remove_owner(patient); }
  /// Removes files nobody knows: what a crash between two steps left. Returns how many.
  int sweep(const OwnedFiles::Known& known) const { return files_.sweep(known); }

 private:
  explicit ScanFiles(OwnedFiles files) : files_(std::move(files)) {}
  OwnedFiles files_;
};

}  // namespace lipofill::server
