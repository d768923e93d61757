#include "client/cpp/dicom/dicom_frame.h"

#include <cmath>
#include <fstream>
#include <functional>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/dicom/dicom_library.h"
#include "client/cpp/dicom/frame_fields.h"

namespace lipofill::client {
namespace {

constexpr int64_t kMaxFrames = 10'000;
/// Pixels may claim to unpack to so many times their file.
constexpr int64_t kMaxRatio = 1000;
constexpr int64_t kMaxPixelsAlong = 65535;
constexpr size_t kMaxDescription = 64;

/// DICOM files have a preamble of 128 bytes and "DICM"; old ones begin with the element of a low
/// group.
bool looks_like_dicom(const std::filesystem::path& file) {
  std::array<char, 132> head{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), head.size());
  const auto count = stream.gcount();
  if (count == 132 && std::string_view(head.data() + 128, 4) == "DICM") return true;
  return count >= 16 && (head[0] == 2 || head[0] == 8) && head[1] == 0 && head[3] == 0;
}

/// A line for a terminal, in ASCII or, where the data set is, in UTF-8: no control characters, not
/// too long.
std::string line_of(DcmItem* data_set, const DcmTagKey& tag) {
  std::string text = text_of(data_set, tag);
  const bool is_utf8 = text_of(data_set, DCM_SpecificCharacterSet) == "ISO_IR 192";
  if (text.size() > kMaxDescription) text.resize(kMaxDescription);
  for (char& c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (absl::ascii_iscntrl(byte) || (!is_utf8 && !absl::ascii_isascii(byte))) c = '?';
  }
  return text;
}

/// Tells patients apart. The value is only compared, never shown.
size_t patient_of(DcmItem* data_set) {
  return std::hash<std::string>()(text_of(data_set, DCM_PatientID) + "\n" + text_of(data_set, DCM_PatientName) + "\n" +
                                  text_of(data_set, DCM_PatientBirthDate));
}

/// Finds what keeps the pixels from being one number each.
std::string find_pixel_problem(DcmItem* data_set) {
  const int64_t samples = whole_number_of(data_set, DCM_SamplesPerPixel, 1);
  if (samples != 1)
    return absl::StrCat("has ", samples,
                        " samples a pixel, a picture in colour, where 1 is read: name the images of the scanner");
  const int64_t allocated = whole_number_of(data_set, DCM_BitsAllocated, 0);
  if (allocated == 1) return "has 1 bit a pixel, a segmentation: name its file, or its series by --series";
  if (allocated != 8 && allocated != 16 && allocated != 32)
    return absl::StrCat("has ", allocated, " bits a pixel, not 8, 16 or 32");
  const int64_t stored = whole_number_of(data_set, DCM_BitsStored, allocated);
  const int64_t high = whole_number_of(data_set, DCM_HighBit, stored - 1);
  if (stored < 1 || stored > allocated || high < stored - 1 || high >= allocated) {
    return absl::StrCat("has BitsStored ", stored, " and HighBit ", high, ", which BitsAllocated ", allocated,
                        " cannot hold");
  }
  const int64_t representation = whole_number_of(data_set, DCM_PixelRepresentation, 0);
  if (representation != 0 && representation != 1)
    return absl::StrCat("has PixelRepresentation ", representation, ", not 0 or 1");
  return {};
}

/// Takes where the image lies in the patient.
std::string take_geometry(const FrameFields& fields, DicomFrame* frame) {
  const auto position = fields.numbers(DCM_PlanePositionSequence, DCM_ImagePositionPatient, 3);
  const auto orientation = fields.numbers(DCM_PlaneOrientationSequence, DCM_ImageOrientationPatient, 6);
  if (!position || !orientation) {
    return absl::StrCat("has no ", position ? "ImageOrientationPatient" : "ImagePositionPatient",
                        " of finite numbers, so it is not known where it lies in the patient (a secondary capture?): "
                        "export the original images");
  }
  std::copy_n(position->begin(), 3, frame->position.begin());
  std::copy_n(orientation->begin(), 6, frame->orientation.begin());
  const auto& o = *orientation;
  const double along = std::hypot(o[0], o[1], o[2]), down = std::hypot(o[3], o[4], o[5]);
  const double between = o[0] * o[3] + o[1] * o[4] + o[2] * o[5];
  if (std::abs(along - 1.0) > 0.01 || std::abs(down - 1.0) > 0.01 || std::abs(between) > 0.01) {
    return absl::StrCat("has ImageOrientationPatient ",
                        fields.text(DCM_PlaneOrientationSequence, DCM_ImageOrientationPatient),
                        ", which is not two unit vectors at right angles");
  }
  const auto spacing = fields.numbers(DCM_PixelMeasuresSequence, DCM_PixelSpacing, 2);
  if (!spacing) return "has no PixelSpacing of two numbers: export it from where it was made";
  frame->spacing = {(*spacing)[1], (*spacing)[0]};
  for (const double mm : frame->spacing) {
    if (!(mm > 1e-3 && mm < 100.0))
      return absl::StrCat("has PixelSpacing ", mm, " mm, not in (0.001, 100): export it from where it was made");
  }
  return {};
}

std::string take_rescale(const FrameFields& fields, DicomFrame* frame) {
  const auto slope = fields.numbers(DCM_PixelValueTransformationSequence, DCM_RescaleSlope, 1);
  const auto intercept = fields.numbers(DCM_PixelValueTransformationSequence, DCM_RescaleIntercept, 1);
  frame->has_rescale = slope && intercept;
  if (slope) frame->slope = slope->front();
  if (intercept) frame->intercept = intercept->front();
  return frame->slope == 0.0 ? "has RescaleSlope 0, which makes all pixels equal" : "";
}

/// Takes what all images of a file share.
DicomFrame take_common(DcmItem* data_set, const std::filesystem::path& file) {
  DicomFrame frame;
  frame.file = file;
  frame.patient = patient_of(data_set);
  frame.series_uid = text_of(data_set, DCM_SeriesInstanceUID);
  frame.image_uid = text_of(data_set, DCM_SOPInstanceUID);
  frame.series_number = whole_number_of(data_set, DCM_SeriesNumber, -1);
  frame.modality = line_of(data_set, DCM_Modality);
  frame.description = line_of(data_set, DCM_SeriesDescription);
  frame.is_localizer = absl::StrContains(text_of(data_set, DCM_ImageType), "LOCALIZER");
  frame.images_in_acquisition = whole_number_of(data_set, DCM_ImagesInAcquisition, 0);
  frame.problem = find_pixel_problem(data_set);
  const int64_t rows = whole_number_of(data_set, DCM_Rows, 0), columns = whole_number_of(data_set, DCM_Columns, 0);
  if (rows < 2 || rows > kMaxPixelsAlong || columns < 2 || columns > kMaxPixelsAlong) {
    frame.problem = absl::StrCat("has ", columns, " x ", rows, " pixels, not in [2, ", kMaxPixelsAlong, "] each way");
    return frame;
  }
  frame.rows = static_cast<uint32_t>(rows);
  frame.columns = static_cast<uint32_t>(columns);
  return frame;
}

/// Tells whether the file can hold as many pixels as its header says, before memory is taken for
/// them.
std::string find_length_problem(DcmDataset* data_set, const DicomFrame& frame, int64_t count) {
  DcmElement* pixels = nullptr;
  if (data_set->findAndGetElement(DCM_PixelData, pixels).bad() || pixels == nullptr) return {};
  const int64_t claimed =
      int64_t{frame.rows} * frame.columns * count * whole_number_of(data_set, DCM_BitsAllocated, 0) / 8;
  const bool packed = DcmXfer(data_set->getOriginalXfer()).isEncapsulated();
  std::error_code error;
  const auto file_bytes = static_cast<int64_t>(std::filesystem::file_size(frame.file, error));
  const int64_t held = packed ? kMaxRatio * file_bytes : static_cast<int64_t>(pixels->getLength());
  if (claimed <= held) return {};
  return absl::StrCat("is cut short or damaged: its header asks for ", claimed, " bytes of pixels, ",
                      packed ? absl::StrCat("its file has ", file_bytes) : absl::StrCat(held, " are there"));
}

void keep_first(std::string* problem, std::string found) {
  if (problem->empty()) *problem = std::move(found);
}

/// Frames of a file without functional groups lie one behind the other, as GridFrameOffsetVector
/// or, without it, SpacingBetweenSlices says.
std::string shift_plain_frame(DcmItem* data_set, const FrameFields& fields, int64_t count, DicomFrame* frame) {
  DcmItem* group = nullptr;
  if (count == 1 || data_set->findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, group, 0).good()) return {};
  const auto offsets = fields.numbers(DCM_PixelMeasuresSequence, DCM_GridFrameOffsetVector, static_cast<size_t>(count));
  const auto between = fields.numbers(DCM_PixelMeasuresSequence, DCM_SpacingBetweenSlices, 1);
  if (!offsets && !between) return "has several frames and does not say where each lies: export it as an Enhanced CT";
  const double shift = offsets ? (*offsets)[frame->number] : between->front() * frame->number;
  const auto& o = frame->orientation;
  const std::array<double, 3> normal{o[1] * o[5] - o[2] * o[4], o[2] * o[3] - o[0] * o[5], o[0] * o[4] - o[1] * o[3]};
  for (size_t k = 0; k < 3; ++k) frame->position[k] += shift * normal[k];
  return {};
}

}  // namespace

absl::StatusOr<std::vector<DicomFrame>> read_dicom_frames(const std::filesystem::path& file) {
  if (!looks_like_dicom(file)) return absl::InvalidArgumentError("is not DICOM");
  prepare_dicom_library();
  DcmFileFormat format;
  const OFCondition loaded = format.loadFile(file.c_str());
  DcmDataset* const data_set = format.getDataset();
  DicomFrame common = take_common(data_set, file);
  if (common.series_uid.empty()) {
    if (loaded.bad()) return absl::InvalidArgumentError("is cut short or damaged");
    return std::vector<DicomFrame>();
  }
  if (loaded.bad()) common.problem = "is cut short or damaged: copy or export it again";
  if (loaded.good() && !data_set->tagExists(DCM_PixelData)) return std::vector<DicomFrame>();
  const int64_t count = whole_number_of(data_set, DCM_NumberOfFrames, 1);
  if (count < 1 || count > kMaxFrames)
    keep_first(&common.problem, absl::StrCat("has ", count, " frames, not in [1, ", kMaxFrames, "]"));
  if (common.problem.empty()) common.problem = find_length_problem(data_set, common, count);
  std::vector<DicomFrame> frames;
  for (int64_t k = 0; k < (common.problem.empty() ? count : 1); ++k) {
    DicomFrame frame = common;
    frame.number = static_cast<uint32_t>(k);
    const FrameFields fields(data_set, static_cast<unsigned long>(k));
    keep_first(&frame.problem, take_geometry(fields, &frame));
    keep_first(&frame.problem, take_rescale(fields, &frame));
    if (frame.problem.empty()) keep_first(&frame.problem, shift_plain_frame(data_set, fields, count, &frame));
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace lipofill::client
