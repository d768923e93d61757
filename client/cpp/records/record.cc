#include "client/cpp/records/record.h"

#include <dcmtk/dcmdata/dcostrmb.h>

#include <ctime>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/dicom/frame_fields.h"
#include "client/cpp/records/record_uid.h"

namespace lipofill::client {
namespace {

constexpr size_t kDecimalBytes = 16;

void put(DcmDataset* record, const DcmTagKey& tag, const std::string& value) {
  record->putAndInsertString(tag, value.c_str());
}

void put_study(const RecordStudy& study, DcmDataset* record) {
  DcmDataset headers(study.headers);
  record->findAndDeleteElement(DCM_SpecificCharacterSet);
  while (DcmElement* element = headers.remove(0UL)) record->insert(element, OFTrue);
}

void put_dates(std::chrono::system_clock::time_point finished, DcmDataset* record) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(finished);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  const std::string date = absl::StrFormat("%04d%02d%02d", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday);
  const std::string time = absl::StrFormat("%02d%02d%02d", utc.tm_hour, utc.tm_min, utc.tm_sec);
  for (const DcmTagKey& tag : {DCM_ContentDate, DCM_SeriesDate}) put(record, tag, date);
  for (const DcmTagKey& tag : {DCM_ContentTime, DCM_SeriesTime}) put(record, tag, time);
  for (const DcmTagKey& tag : {DCM_InstanceCreationDate, DCM_InstanceCreationTime, DCM_InstanceCreatorUID})
    record->findAndDeleteElement(tag);
}

void put_equipment(DcmDataset* record) {
  put(record, DCM_Manufacturer, "The Lipofill project");
  put(record, DCM_ManufacturerModelName, "Lipofill");
  put(record, DCM_DeviceSerialNumber, "none");
  put(record, DCM_SoftwareVersions, LIPOFILL_VERSION);
}

/// The bytes of a data set, as they are in its file.
std::string bytes_of(DcmDataset* record) {
  const auto size = record->calcElementLength(EXS_LittleEndianExplicit, EET_UndefinedLength) + 64;
  std::string bytes(size, '\0');
  DcmOutputBufferStream stream(bytes.data(), static_cast<offile_off_t>(bytes.size()));
  record->transferInit();
  record->write(stream, EXS_LittleEndianExplicit, EET_UndefinedLength, nullptr);
  record->transferEnd();
  void* start = nullptr;
  offile_off_t written = 0;
  stream.flushBuffer(start, written);
  bytes.resize(static_cast<size_t>(written));
  return bytes;
}

}  // namespace

void finish_record(const RecordStudy& study, const RecordKind& kind, std::chrono::system_clock::time_point finished,
                   DcmDataset* record) {
  put_study(study, record);
  put_dates(finished, record);
  put_equipment(record);
  put(record, DCM_Modality, kind.modality);
  put(record, DCM_SeriesNumber, absl::StrCat(kind.series_number));
  put(record, DCM_SeriesDescription, kind.description);
  put(record, DCM_InstanceNumber, "1");
  for (const DcmTagKey& tag : {DCM_SeriesInstanceUID, DCM_SOPInstanceUID}) record->findAndDeleteElement(tag);
  const std::string content = bytes_of(record);
  put(record, DCM_SeriesInstanceUID, uid_of("series", content));
  put(record, DCM_SOPInstanceUID, uid_of("instance", content));
}

std::string plain_text(std::string_view text, size_t most) {
  std::string plain(text.substr(0, most));
  for (char& c : plain) {
    const auto byte = static_cast<unsigned char>(c);
    // A backslash parts values.
    if (!absl::ascii_isprint(byte) || c == '\\') c = '?';
  }
  return plain;
}

std::string decimal_string(double value) {
  std::string text;
  for (int digits = 15; digits > 0; --digits) {
    text = absl::StrFormat("%.*g", digits, value);
    if (text.size() <= kDecimalBytes) break;
  }
  return text;
}

absl::Status write_record(const std::filesystem::path& file, DcmDataset* record) {
  DcmFileFormat format(record);
  // Archives keep sequences in the encoding that DCMTK sends them in, which is this one: what comes
  // back is so the same to the byte.
  const OFCondition written = format.saveFile(file.c_str(), EXS_LittleEndianExplicit, EET_UndefinedLength);
  if (written.bad())
    return absl::InvalidArgumentError(absl::StrCat("cannot write ", file.string(), ": ", written.text()));
  return absl::OkStatus();
}

}  // namespace lipofill::client
