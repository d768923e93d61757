#pragma once

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <filesystem>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/cpp/dicom/dicom_listing.h"
#include "client/cpp/dicom/dicom_source.h"

namespace lipofill::client {

/// The study that records become part of. It is the only place where attributes of a patient are
/// kept, and they go into records of this study and nowhere else.
struct RecordStudy {
  DcmDataset headers;  ///< the attributes of the patient and of the study, and no others
  std::string study_uid;
  std::string frame_of_reference_uid;   ///< of the series; empty where it has none
  std::string image_class_uid;          ///< the SOP class of the series' images
  std::optional<DicomSeries> series;    ///< the volume that the scan came from; none in a study without one
  std::shared_ptr<DicomSource> source;  ///< keeps the files of `series` where they are
};

/// Reads the study of a folder, a zip or a file of DICOM. Its volume is chosen as that of `lipofill
/// scan extract` is; a source without any image of a volume gives its study alone. INVALID_ARGUMENT
/// for no DICOM, several patients or studies without a wanted series, and a study without a UID.
/// Checked by tests/unit/client/records_test.cc.
/// @param series  a SeriesNumber or SeriesInstanceUID; empty: the largest axial CT
absl::StatusOr<RecordStudy> read_record_study(const std::filesystem::path& source, const std::string& series);

}  // namespace lipofill::client
