#include "client/cpp/records/fat_segmentation.h"

#include <dcmtk/dcmfg/fgderimg.h>
#include <dcmtk/dcmfg/fgfracon.h>
#include <dcmtk/dcmfg/fgpixmsr.h>
#include <dcmtk/dcmfg/fgplanor.h>
#include <dcmtk/dcmfg/fgplanpo.h>
#include <dcmtk/dcmseg/segdoc.h>
#include <dcmtk/dcmseg/segment.h>

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/records/fat_voxels.h"
#include "client/cpp/records/record.h"
#include "client/cpp/records/record_uid.h"

namespace lipofill::client {
namespace {

constexpr size_t kLabelBytes = 64;
/// A face that the fat lifts may leave the images where they end near it.
constexpr double kMostSkinOutside = 0.05;

OFString decimal(double value) {
  return decimal_string(value).c_str();
}

/// Turns what a call of DCMTK answers into a status.
absl::Status check(const OFCondition& condition, absl::string_view doing) {
  if (condition.good()) return absl::OkStatus();
  return absl::InternalError(absl::StrCat("cannot ", doing, ": ", condition.text()));
}

absl::StatusOr<std::unique_ptr<DcmSegmentation>> begin(const DicomStack& stack, const RecordStudy& study) {
  const DicomFrame& first = stack.slices.front();
  const IODGeneralEquipmentModule::EquipmentInfo equipment("The Lipofill project", "Lipofill", "none",
                                                           LIPOFILL_VERSION);
  const ContentIdentificationMacro content("1", "PLANNED_FAT", "Fat of a plan. No medical device.", "Lipofill");
  DcmSegmentation* made = nullptr;
  const OFCondition created = DcmSegmentation::createBinarySegmentation(
      made, static_cast<Uint16>(first.rows), static_cast<Uint16>(first.columns), equipment, content);
  std::unique_ptr<DcmSegmentation> segmentation(made);
  if (auto status = check(created, "begin a segmentation"); !status.ok()) return status;

  const auto& o = first.orientation;
  const std::unique_ptr<FGPlaneOrientationPatient> orientation(FGPlaneOrientationPatient::createMinimal(
      decimal(o[0]), decimal(o[1]), decimal(o[2]), decimal(o[3]), decimal(o[4]), decimal(o[5])));
  FGPixelMeasures measures;
  // PixelSpacing names the distance between rows first.
  measures.setPixelSpacing(
      absl::StrCat(decimal_string(first.spacing[1]), "\\", decimal_string(first.spacing[0])).c_str());
  measures.setSpacingBetweenSlices(decimal(stack.slice_spacing));
  measures.setSliceThickness(decimal(stack.slice_spacing));
  segmentation->addForAllFrames(*orientation);
  segmentation->addForAllFrames(measures);

  IODMultiframeDimensionModule& dimensions = segmentation->getDimensions();
  const OFString organisation = uid_of("dimensions", study.series->uid).c_str();
  dimensions.addDimensionIndex(DCM_ReferencedSegmentNumber, organisation, DCM_SegmentIdentificationSequence, "Segment");
  dimensions.addDimensionIndex(DCM_ImagePositionPatient, organisation, DCM_PlanePositionSequence, "Slice");
  segmentation->getFrameOfReference().setFrameOfReferenceUID(study.frame_of_reference_uid.c_str());
  return segmentation;
}

absl::StatusOr<Uint16> add_segment(DcmSegmentation* segmentation, const std::string& film, const FatVoxels& fat) {
  DcmSegment* segment = nullptr;
  const OFCondition made = DcmSegment::create(
      segment, plain_text(absl::StrCat("Planned fat: ", film), kLabelBytes).c_str(),
      CodeSequenceMacro("85756007", "SCT", "Tissue"), CodeSequenceMacro("55603005", "SCT", "Adipose tissue"),
      DcmSegTypes::SAT_AUTOMATIC, "Lipofill");
  if (auto status = check(made, "make a segment"); !status.ok()) return status;
  segment->setSegmentDescription(
      absl::StrFormat("%.2f mL of fat, %.2f mL of voxels. A plan.", fat.film_ml, fat.voxels_ml).c_str());
  segment->setRecommendedDisplayCIELabValue(58000, 33000, 50000);
  Uint16 number = 0;
  if (auto status = check(segmentation->addSegment(segment, number), "add a segment"); !status.ok()) return status;
  return number;
}

/// Tells whether every image is a file of its own that can be named; frames of one file are not.
bool can_name_images(const RecordStudy& study) {
  const std::vector<DicomFrame>& slices = study.series->stack.slices;
  return !study.image_class_uid.empty() && slices.front().file != slices.back().file &&
         std::none_of(slices.begin(), slices.end(), [](const DicomFrame& each) { return each.image_uid.empty(); });
}

/// The image that a frame was drawn on; none where it cannot be named.
std::unique_ptr<FGDerivationImage> source_of(const RecordStudy& study, const DicomFrame& slice) {
  if (!can_name_images(study)) return nullptr;
  ImageSOPInstanceReferenceMacro* made = nullptr;
  ImageSOPInstanceReferenceMacro::create(study.image_class_uid.c_str(), slice.image_uid.c_str(), made);
  const std::unique_ptr<ImageSOPInstanceReferenceMacro> reference(made);
  OFVector<ImageSOPInstanceReferenceMacro> references;
  if (reference) references.push_back(*reference);
  return std::unique_ptr<FGDerivationImage>(
      DcmSegmentation::createDerivationImageFG(references, "Voxels of which half is planned fat"));
}

absl::Status add_frames(const RecordStudy& study, FatVoxels& fat, Uint16 segment, DcmSegmentation* segmentation) {
  for (auto& [k, pixels] : fat.slices) {
    const DicomFrame& slice = study.series->stack.slices[k];
    const std::unique_ptr<FGPlanePosPatient> position(FGPlanePosPatient::createMinimal(
        decimal(slice.position[0]), decimal(slice.position[1]), decimal(slice.position[2])));
    FGFrameContent content;
    content.setStackID("1");
    content.setInStackPositionNumber(static_cast<Uint32>(k + 1));
    content.setDimensionIndexValues(segment, 0);
    content.setDimensionIndexValues(static_cast<Uint32>(k + 1), 1);
    const auto source = source_of(study, slice);
    OFVector<FGBase*> own;
    own.push_back(position.get());
    own.push_back(&content);
    if (source) own.push_back(source.get());
    if (auto status = check(segmentation->addFrame(pixels.data(), segment, own), "add a frame"); !status.ok())
      return status;
  }
  return absl::OkStatus();
}

/// Says which images the frames were drawn on (PS3.3, C.12.2).
void put_references(const RecordStudy& study, const std::vector<std::string>& images, DcmDataset* record) {
  if (images.empty()) return;
  DcmItem* series = nullptr;
  record->findOrCreateSequenceItem(DCM_ReferencedSeriesSequence, series, 0);
  series->putAndInsertString(DCM_SeriesInstanceUID, study.series->uid.c_str());
  for (const std::string& image : images) {
    DcmItem* reference = nullptr;
    series->findOrCreateSequenceItem(DCM_ReferencedInstanceSequence, reference, -2);
    reference->putAndInsertString(DCM_ReferencedSOPClassUID, study.image_class_uid.c_str());
    reference->putAndInsertString(DCM_ReferencedSOPInstanceUID, image.c_str());
  }
}

/// DCMTK wants a patient and a study before it writes; finish_record puts in what they are.
absl::StatusOr<std::unique_ptr<DcmDataset>> write(const RecordStudy& study, DcmSegmentation* segmentation) {
  DcmDataset hierarchy(study.headers);
  segmentation->importHierarchy(hierarchy, OFTrue, OFTrue);
  segmentation->getSeries().setSeriesNumber("1");
  auto record = std::make_unique<DcmDataset>();
  if (auto status = check(segmentation->writeDataset(*record), "write a segmentation"); !status.ok()) return status;
  return record;
}

}  // namespace

absl::StatusOr<FatRecord> make_fat_record(const RecordStudy& study, const FinishedPlan& plan) {
  if (!study.series)
    return absl::FailedPreconditionError("the study holds no volume whose voxels the fat could be drawn on");
  if (study.frame_of_reference_uid.empty())
    return absl::FailedPreconditionError(
        "the series has no FrameOfReferenceUID, so a segmentation cannot say where it lies");
  if (const double share = find_share_outside(plan.skin, study.series->stack); share > kMostSkinOutside) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%.0f %% of the planned skin lie outside of the series: the plan was not made on the skin of this series, in "
        "LPS",
        100.0 * share));
  }
  auto segmentation = begin(study.series->stack, study);
  if (!segmentation.ok()) return segmentation.status();
  FatRecord result;
  std::set<size_t> drawn_on;
  for (const PlannedFilm& film : plan.films) {
    auto fat = find_fat_voxels(film.cells, study.series->stack);
    if (!fat.ok()) return fat.status();
    result.film_ml += fat->film_ml;
    if (fat->slices.empty()) continue;
    const auto segment = add_segment(segmentation->get(), film.name, *fat);
    if (!segment.ok()) return segment.status();
    if (auto status = add_frames(study, *fat, *segment, segmentation->get()); !status.ok()) return status;
    result.voxels_ml += fat->voxels_ml;
    result.frames += fat->slices.size();
    for (const auto& [slice, pixels] : fat->slices) drawn_on.insert(slice);
  }
  if (result.frames == 0) {
    return absl::FailedPreconditionError(
        absl::StrFormat("no voxel of the series is half fat: %.3f mL are spread thinner than that", result.film_ml));
  }
  auto record = write(study, segmentation->get());
  if (!record.ok()) return record.status();
  std::vector<std::string> images;
  for (const size_t slice : drawn_on) {
    if (can_name_images(study)) images.push_back(study.series->stack.slices[slice].image_uid);
  }
  put_references(study, images, record->get());
  finish_record(study, kFatRecord, plan.finished, record->get());
  result.record = *std::move(record);
  return result;
}

}  // namespace lipofill::client
