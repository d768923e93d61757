#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "absl/status/status.h"
#include "client/cpp/records/record_study.h"

namespace lipofill::client {

/// The kind says what series a record is of; each kind has one of its own in the study.
struct RecordKind {
  const char* modality;
  int series_number;
  const char* description;
};

inline constexpr RecordKind kReportRecord = {"DOC", 9101, "Lipofill: report of the plan"};
inline constexpr RecordKind kSkinRecord = {"M3D", 9102, "Lipofill: planned skin"};
inline constexpr RecordKind kFiguresRecord = {"SR", 9103, "Lipofill: figures of the plan"};
inline constexpr RecordKind kFatRecord = {"SEG", 9104, "Lipofill: planned fat"};

/// Makes a data set a record: puts in patient and study, series, equipment, dates and UIDs. What is
/// in it already stays, but for these. The UIDs follow from the content (record_uid.h), dates from
/// `finished`, so the same result gives the same bytes. Checked by
/// tests/unit/client/records_test.cc.
/// @param record    holds its SOPClassUID and everything of its own
/// @param finished  when the plan had its result; written in UTC
void finish_record(const RecordStudy& study, const RecordKind& kind, std::chrono::system_clock::time_point finished,
                   DcmDataset* record);

/// Text without what other character sets read otherwise: bytes beyond ASCII become '?'. A record
/// keeps the character set of its study, so that the patient's name stays what it is.
std::string plain_text(std::string_view text, size_t most);

/// A number as DICOM's decimal strings hold it, in at most 16 characters.
std::string decimal_string(double value);

/// Writes a record as a DICOM file, explicit little endian. INVALID_ARGUMENT where it cannot be
/// written.
absl::Status write_record(const std::filesystem::path& file, DcmDataset* record);

}  // namespace lipofill::client
