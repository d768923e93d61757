#include "client/cpp/records/record_study.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "client/cpp/dicom/dicom_choice.h"
#include "client/cpp/dicom/dicom_library.h"
#include "client/cpp/dicom/frame_fields.h"

namespace lipofill::client {
namespace {

/// These tags identify the patient and the study (PS3.3, C.7.1.1, C.7.2.1 and C.7.2.2).
const DcmTagKey kStudyTags[] = {DCM_SpecificCharacterSet,
                                DCM_TimezoneOffsetFromUTC,
                                DCM_PatientName,
                                DCM_PatientID,
                                DCM_IssuerOfPatientID,
                                DCM_TypeOfPatientID,
                                DCM_PatientBirthDate,
                                DCM_PatientSex,
                                DCM_PatientIdentityRemoved,
                                DCM_DeidentificationMethod,
                                DCM_DeidentificationMethodCodeSequence,
                                DCM_PatientAge,
                                DCM_StudyInstanceUID,
                                DCM_StudyDate,
                                DCM_StudyTime,
                                DCM_StudyID,
                                DCM_StudyDescription,
                                DCM_AccessionNumber,
                                DCM_ReferringPhysicianName};

/// These have to be there, if empty (type 2).
const DcmTagKey kRequiredTags[] = {DCM_PatientName, DCM_PatientID,       DCM_PatientBirthDate,
                                   DCM_PatientSex,  DCM_StudyDate,       DCM_StudyTime,
                                   DCM_StudyID,     DCM_AccessionNumber, DCM_ReferringPhysicianName};

absl::Status load_headers(const std::filesystem::path& file, DcmFileFormat* format) {
  const OFCondition loaded = format->loadFileUntilTag(file.c_str(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength,
                                                      ERM_autoDetect, DCM_PixelData);
  if (loaded.bad()) return absl::InvalidArgumentError("is not DICOM");
  return absl::OkStatus();
}

absl::Status take_study(DcmDataset* from, RecordStudy* study) {
  for (const DcmTagKey& tag : kStudyTags) {
    DcmElement* element = nullptr;
    if (from->findAndGetElement(tag, element).good() && element != nullptr)
      study->headers.insert(dynamic_cast<DcmElement*>(element->clone()), OFTrue);
  }
  for (const DcmTagKey& tag : kRequiredTags) {
    if (!study->headers.tagExists(tag)) study->headers.insertEmptyElement(tag);
  }
  study->study_uid = text_of(from, DCM_StudyInstanceUID);
  study->frame_of_reference_uid = text_of(from, DCM_FrameOfReferenceUID);
  study->image_class_uid = text_of(from, DCM_SOPClassUID);
  if (study->study_uid.empty())
    return absl::InvalidArgumentError("has no StudyInstanceUID, so no record can become part of its study");
  return absl::OkStatus();
}

/// The study of a source without a volume: all of its files must be of one.
absl::Status take_only_study(const std::filesystem::path& path, RecordStudy* study) {
  bool found = false;
  for (const std::filesystem::path& file : study->source->files()) {
    DcmFileFormat format;
    if (!load_headers(file, &format).ok()) continue;
    const std::string uid = text_of(format.getDataset(), DCM_StudyInstanceUID);
    if (uid.empty()) continue;
    if (found && uid != study->study_uid) {
      return absl::InvalidArgumentError(
          absl::StrCat(path.string(), " holds more than one study; name a file or a folder of one"));
    }
    if (found) continue;
    if (auto status = take_study(format.getDataset(), study); !status.ok()) return status;
    found = true;
  }
  if (!found) return absl::InvalidArgumentError(absl::StrCat(path.string(), " holds no DICOM of a study"));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<RecordStudy> read_record_study(const std::filesystem::path& source, const std::string& series) {
  prepare_dicom_library();
  auto files = DicomSource::open(source);
  if (!files.ok()) return files.status();
  RecordStudy study;
  study.source = std::make_shared<DicomSource>(*std::move(files));
  const DicomListing listing = list_series(*study.source, true);
  const bool has_volume = std::any_of(listing.series.begin(), listing.series.end(),
                                      [](const DicomSeries& each) { return each.problem.empty(); });
  if (!has_volume && series.empty()) {
    if (auto status = take_only_study(source, &study); !status.ok()) return status;
    return study;
  }
  auto chosen = choose_series(source, listing, series);
  if (!chosen.ok()) return chosen.status();
  DcmFileFormat format;
  const std::filesystem::path& first = chosen->stack.slices.front().file;
  absl::Status taken = load_headers(first, &format);
  if (taken.ok()) taken = take_study(format.getDataset(), &study);
  if (!taken.ok())
    return absl::InvalidArgumentError(
        absl::StrCat("the series ", chosen->label(), " of ", source.string(), " ", taken.message()));
  study.series = *std::move(chosen);
  return study;
}

}  // namespace lipofill::client
