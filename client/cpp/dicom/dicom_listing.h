#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/dicom/dicom_source.h"
#include "client/cpp/dicom/dicom_stack.h"

namespace lipofill::client {

/// A series and what can be made of it.
struct DicomSeries {
  int64_t number = -1;  ///< -1: none
  std::string uid;
  std::string modality;
  std::string description;
  size_t images = 0;
  size_t patient = 0;   ///< only compared, never shown
  DicomStack stack;     ///< empty where there is a problem
  std::string problem;  ///< why it is no volume; empty where it is

  uint64_t voxels() const;
  /// "3 (CT, 512 x 512 x 120)", for messages.
  std::string label() const;
};

/// The listing is what a source holds.
struct DicomListing {
  std::vector<DicomSeries> series;  ///< by number, then UID
  size_t patients = 0;
  size_t other_files = 0;       ///< no DICOM
  size_t unreadable_files = 0;  ///< DICOM, cut short before it says what it is
  size_t without_image = 0;     ///< DICOM without an image, such as a report
  std::string first_unreadable;
};

/// Reads the headers of all files of a source, and stacks each series. Checked by
/// tests/unit/client/dicom_series_test.cc.
DicomListing list_series(const DicomSource& source, bool bridge_gaps);

}  // namespace lipofill::client
