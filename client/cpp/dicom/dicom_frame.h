#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// One image of a DICOM file, as its header has it. Names and numbers of the patient are not among
/// it: `patient` only tells whether two images are of the same one.
struct DicomFrame {
  std::filesystem::path file;
  uint32_t number = 0;  ///< in its file, from 0
  size_t patient = 0;
  std::string series_uid;
  std::string image_uid;
  int64_t series_number = -1;  ///< -1: none
  std::string modality;
  std::string description;
  bool is_localizer = false;
  int64_t images_in_acquisition = 0;  ///< 0: not said

  uint32_t rows = 0;
  uint32_t columns = 0;
  std::array<double, 3> position{};     ///< [mm] LPS, the centre of the first pixel
  std::array<double, 6> orientation{};  ///< unit vectors along a row and down a column
  std::array<double, 2> spacing{};      ///< [mm] between columns, between rows
  bool has_rescale = false;
  double slope = 1.0;  ///< value = slope * pixel + intercept
  double intercept = 0.0;

  /// Why the image cannot be part of a volume; empty where it can.
  std::string problem;
};

/// The images in a file; none for a DICOM file without any. INVALID_ARGUMENT, without the file's
/// name, for what is no DICOM. Pixels stay on the disk. Checked by
/// tests/unit/client/dicom_series_test.cc and tests/fuzz/dicom_fuzzer.cc.
absl::StatusOr<std::vector<DicomFrame>> read_dicom_frames(const std::filesystem::path& file);

}  // namespace lipofill::client
