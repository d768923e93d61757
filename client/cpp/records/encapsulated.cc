#include "client/cpp/records/encapsulated.h"

#include <vtkCellArray.h>
#include <vtkCellArrayIterator.h>
#include <vtkPoints.h>

#include <Eigen/Geometry>
#include <array>
#include <cstring>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/records/record.h"
#include "client/cpp/records/record_uid.h"
#include "client/cpp/result_text.h"

namespace lipofill::client {
namespace {

constexpr size_t kStlHeadBytes = 80;
constexpr size_t kTitleBytes = 64;

void put_code(DcmItem* record, const DcmTagKey& sequence, const char* value, const char* scheme, const char* meaning) {
  DcmItem* item = nullptr;
  record->findOrCreateSequenceItem(sequence, item, 0);
  item->putAndInsertString(DCM_CodeValue, value);
  item->putAndInsertString(DCM_CodingSchemeDesignator, scheme);
  item->putAndInsertString(DCM_CodeMeaning, meaning);
}

/// Makes what all encapsulated documents have (PS3.3, C.24.2). The document has its length beside
/// it, for DICOM pads it to an even one.
std::unique_ptr<DcmDataset> encapsulate(const std::string& document, const char* class_uid, const char* mime_type,
                                        const std::string& title) {
  auto record = std::make_unique<DcmDataset>();
  record->putAndInsertString(DCM_SOPClassUID, class_uid);
  record->insertEmptyElement(DCM_AcquisitionDateTime);
  record->putAndInsertString(DCM_BurnedInAnnotation, "YES");
  record->putAndInsertString(DCM_DocumentTitle, plain_text(title, kTitleBytes).c_str());
  record->putAndInsertString(DCM_MIMETypeOfEncapsulatedDocument, mime_type);
  std::string padded = document;
  if (padded.size() % 2 == 1) padded.push_back('\0');
  record->putAndInsertUint8Array(DCM_EncapsulatedDocument, reinterpret_cast<const Uint8*>(padded.data()),
                                 padded.size());
  record->putAndInsertUint32(DCM_EncapsulatedDocumentLength, static_cast<Uint32>(document.size()));
  return record;
}

template <typename Value>
void append(std::string* bytes, const Value& value) {
  const size_t at = bytes->size();
  bytes->resize(at + sizeof value);
  std::memcpy(bytes->data() + at, &value, sizeof value);
}

void append_triangle(const std::array<Eigen::Vector3d, 3>& corners, std::string* bytes) {
  Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (normal.norm() > 0.0) normal.normalize();
  for (const Eigen::Vector3d& vector : {normal, corners[0], corners[1], corners[2]}) {
    for (int c = 0; c < 3; ++c) append(bytes, static_cast<float>(vector[c]));
  }
  append(bytes, uint16_t{0});
}

}  // namespace

std::string stl_bytes(vtkPolyData* surface) {
  std::string bytes = absl::StrCat("Lipofill: planned skin, mm. ", kNotAMedicalDevice);
  bytes.resize(kStlHeadBytes, ' ');
  append(&bytes, uint32_t{0});
  uint32_t count = 0;
  const auto point = [surface](vtkIdType id) {
    Eigen::Vector3d p;
    surface->GetPoint(id, p.data());
    return p;
  };
  const auto cells = vtk::TakeSmartPointer(surface->GetPolys()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell()) {
    vtkIdType size = 0;
    const vtkIdType* corners = nullptr;
    cells->GetCurrentCell(size, corners);
    for (vtkIdType k = 2; k < size; ++k, ++count) {
      append_triangle({point(corners[0]), point(corners[k - 1]), point(corners[k])}, &bytes);
    }
  }
  std::memcpy(bytes.data() + kStlHeadBytes, &count, sizeof count);
  return bytes;
}

absl::StatusOr<std::unique_ptr<DcmDataset>> make_report_record(const RecordStudy& study, const FinishedPlan& plan,
                                                               const std::string& pdf) {
  if (!absl::StartsWith(pdf, "%PDF-")) return absl::InvalidArgumentError("does not begin as a PDF does, with %PDF-");
  auto record = encapsulate(pdf, UID_EncapsulatedPDFStorage, "application/pdf",
                            absl::StrCat("Plan of fat grafting: ", plan.name));
  record->putAndInsertString(DCM_ConversionType, "WSD");
  put_code(record.get(), DCM_ConceptNameCodeSequence, "18776-5", "LN", "Plan of care note");
  finish_record(study, kReportRecord, plan.finished, record.get());
  return record;
}

std::unique_ptr<DcmDataset> make_skin_record(const RecordStudy& study, const FinishedPlan& plan) {
  auto record = encapsulate(stl_bytes(plan.skin), UID_EncapsulatedSTLStorage, "model/stl",
                            absl::StrCat("Planned skin: ", plan.name));
  record->putAndInsertString(DCM_BurnedInAnnotation, "NO");
  record->insertEmptyElement(DCM_ConceptNameCodeSequence);
  put_code(record.get(), DCM_MeasurementUnitsCodeSequence, "mm", "UCUM", "mm");
  record->putAndInsertString(DCM_ModelModification, "YES");
  record->putAndInsertString(DCM_ModelMirroring, "NO");
  // A scan that came from no volume of the study has a frame of its own.
  const std::string frame =
      study.frame_of_reference_uid.empty() ? uid_of("frame", study.study_uid) : study.frame_of_reference_uid;
  record->putAndInsertString(DCM_FrameOfReferenceUID, frame.c_str());
  record->insertEmptyElement(DCM_PositionReferenceIndicator);
  finish_record(study, kSkinRecord, plan.finished, record.get());
  return record;
}

}  // namespace lipofill::client
