#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// The files that a folder, a zip or a single file of DICOM holds. A zip is unpacked, its DICOM
/// files alone and under names of its own, into a private folder that goes with this object.
/// Checked by tests/unit/client/dicom_source_test.cc.
class DicomSource {
 public:
  /// INVALID_ARGUMENT for what does not exist, more than kMaxFiles files, a zip that is damaged or
  /// encrypted, or one that unpacks to more than allowed_bytes of its size.
  static absl::StatusOr<DicomSource> open(const std::filesystem::path& path);

  /// Files that may be DICOM, in the order of their names.
  const std::vector<std::filesystem::path>& files() const { return files_; }

  /// Tells whether `path` is to be read as DICOM: a folder, a zip, .dcm, or a file that begins as
  /// DICOM.
  static bool is_dicom(const std::filesystem::path& path);

  /// Bytes that a zip may unpack to. Slices of a CT shrink to a half or, of much air, a tenth.
  static uint64_t allowed_bytes(uint64_t zip_bytes);

  static constexpr size_t kMaxFiles = 100'000;

 private:
  struct Scratch;
  absl::Status take_folder(const std::filesystem::path& folder);
  absl::Status unpack(const std::filesystem::path& zip);

  std::vector<std::filesystem::path> files_;
  std::shared_ptr<Scratch> scratch_;
};

}  // namespace lipofill::client
