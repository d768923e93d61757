#pragma once

#include <filesystem>

#include "absl/status/statusor.h"
#include "client/cpp/dicom/dicom_volume.h"
#include "client/cpp/volume/volume_reader.h"

namespace lipofill::client {

/// Reads whatever holds a volume: a file of read_volume(), a DICOM segmentation (alone, or the
/// series that `dicom` names), or a series of a folder, a zip or a file of DICOM, which a remark
/// then names with its size. INVALID_ARGUMENT with what is wrong and the next step. Checked by
/// tests/unit/client/segmentation_test.cc and tests/integration/cli/dicom_test.cc.
absl::StatusOr<Volume> read_any_volume(const std::filesystem::path& path, const DicomReading& dicom);

}  // namespace lipofill::client
