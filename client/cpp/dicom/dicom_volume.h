#pragma once

#include <filesystem>
#include <string>

#include "absl/status/statusor.h"
#include "client/cpp/dicom/dicom_listing.h"
#include "client/cpp/volume/volume_reader.h"

namespace lipofill::client {

struct DicomReading {
  std::string series = {};   ///< SeriesNumber or SeriesInstanceUID; empty: the largest axial CT
  bool bridge_gaps = false;  ///< cross missing slices in a straight line
};

/// A volume of a DICOM series. Of the headers it holds what says where and what the voxels are, and
/// nothing of the patient.
struct DicomVolume {
  Volume volume;
  int64_t series_number = -1;
  std::string modality;
  std::array<uint64_t, 3> size{};
  std::array<double, 3> spacing_mm{};
};

/// Lists what a folder, a zip or a file of DICOM holds. INVALID_ARGUMENT for what cannot be read.
absl::StatusOr<DicomListing> list_dicom(const std::filesystem::path& path);

/// Reads one series of a folder, a zip or a file of several frames. The voxels keep their type
/// where all slices have one rescale, else they are rescaled to float; those that the header says
/// show nothing are air. Takes memory for the voxels once, and one slice. INVALID_ARGUMENT with
/// what is wrong and the next step. Checked by tests/unit/client/dicom_series_test.cc and
/// dicom_pixels_test.cc.
absl::StatusOr<DicomVolume> read_dicom_volume(const std::filesystem::path& path, const DicomReading& options);

}  // namespace lipofill::client
