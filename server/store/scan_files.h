#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::server {

/// The bytes of uploaded scans, a file each: <root>/<patient>/<scan>. Ids are checked by whoever calls: they hold no
/// separators. Checked by tests/unit/server/scan_files_test.cc.
class ScanFiles {
 public:
  static absl::StatusOr<ScanFiles> open(const std::filesystem::path& root);

  /// Bytes on disk, 0 where there is no file.
  uint64_t size(const std::string& patient, const std::string& scan) const;
  /// Writes at an offset, making the file where there is none. RESOURCE_EXHAUSTED when the disk is full.
  absl::Status write(const std::string& patient, const std::string& scan, uint64_t offset,
                     std::string_view bytes) const;
  /// Waits until all that was written to a scan is on the medium.
  absl::Status flush(const std::string& patient, const std::string& scan) const;
  absl::StatusOr<std::string> read(const std::string& patient, const std::string& scan) const;
  void remove(const std::string& patient, const std::string& scan) const;
  void remove_patient(const std::string& patient) const;
  /// Removes files nobody knows: what a crash between two steps left. Returns how many.
  int sweep(const std::function<bool(const std::string& patient, const std::string& scan)>& known) const;

 private:
  explicit ScanFiles(std::filesystem::path root) : root_(std::move(root)) {}
  std::filesystem::path root_;
};

}  // namespace lipofill::server
