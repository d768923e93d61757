#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "absl/status/statusor.h"
#include "client/cpp/connection.h"
#include "lipofill/v1/patient_service.pb.h"

namespace lipofill::client {

inline constexpr size_t kUploadChunkBytes = size_t{1} << 20;

/// Bytes sent and bytes in all.
using UploadProgress = std::function<void(uint64_t, uint64_t)>;

/// The format a file's extension names; INVALID_ARGUMENT for any but .obj, .ply and .stl.
absl::StatusOr<v1::ScanFormat> scan_format_of(const std::filesystem::path& file);

/// SHA-256 of a file, lower-case hex.
absl::StatusOr<std::string> sha256_of_file(const std::filesystem::path& file);

/// Announces a scan under a patient and sends its bytes in chunks of at most 1 MiB. A stream that
/// breaks is taken up from what the daemon has received; a scan of the same bytes that the same
/// request began before is completed, not sent again.
/// @param parent  patients/{patient}
/// Checked by tests/unit/client/scan_upload_test.cc and tests/integration/cli/.
absl::StatusOr<v1::Scan> upload_scan(const Connection& connection, const std::string& parent,
                                     const std::filesystem::path& file, v1::ScanUnit unit,
                                     const UploadProgress& progress = {});

}  // namespace lipofill::client
