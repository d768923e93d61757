#pragma once

#include <filesystem>
#include <string>

#include "absl/status/statusor.h"
#include "client/cpp/dicom/dicom_listing.h"

namespace lipofill::client {

/// INVALID_ARGUMENT, with what the files are and the next step, where a source holds no image.
/// Checked by tests/integration/cli/dicom_test.cc.
absl::Status check_has_images(const std::filesystem::path& source, const DicomListing& listing);

/// The series to read. `wanted` is a SeriesNumber or a SeriesInstanceUID; empty, it is the largest
/// axial CT, else the largest axial MR, else the largest of any. INVALID_ARGUMENT, with the series
/// there are and the next step, for none, for several patients without a wanted series, or for a
/// series that is no volume. Checked by tests/unit/client/dicom_series_test.cc.
/// @param source  what the user named, for messages
absl::StatusOr<DicomSeries> choose_series(const std::filesystem::path& source, const DicomListing& listing,
                                          const std::string& wanted);

}  // namespace lipofill::client
