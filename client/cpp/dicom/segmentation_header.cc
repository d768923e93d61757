#include "client/cpp/dicom/segmentation_header.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <algorithm>
#include <cmath>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/dicom/dicom_library.h"
#include "client/cpp/dicom/frame_fields.h"

namespace lipofill::client {
namespace {

using Eigen::Vector3d;

constexpr int64_t kMostFrames = 100'000;
constexpr int64_t kMostPixelsAlong = 65'535;
constexpr int64_t kMostSegments = 65'535;
/// Planes may lie off an even grid by this part of its spacing.
constexpr double kOffGrid = 0.1;
/// Packed frames shrink at most so far.
constexpr int64_t kMaxRatio = 1000;

absl::Status bad(absl::string_view what) {
  return absl::InvalidArgumentError(what);
}

std::string code_meaning(DcmItem* segment, const DcmTagKey& sequence) {
  DcmItem* code = nullptr;
  return segment->findAndGetSequenceItem(sequence, code, 0).good() ? text_of(code, DCM_CodeMeaning) : "";
}

absl::Status take_segments(DcmItem* data_set, SegmentationHeader* header) {
  DcmSequenceOfItems* sequence = nullptr;
  if (data_set->findAndGetSequence(DCM_SegmentSequence, sequence).bad() || sequence == nullptr)
    return bad("has no SegmentSequence, so its segments are not known");
  for (DcmObject* item = nullptr; (item = sequence->nextInContainer(item)) != nullptr;) {
    auto* const segment = dynamic_cast<DcmItem*>(item);
    if (segment == nullptr) continue;
    const int64_t number = whole_number_of(segment, DCM_SegmentNumber, 0);
    if (number < (header->is_label_map ? 0 : 1) || number > kMostSegments)
      return bad(absl::StrCat("has a segment of the number ", number, ", not in [1, ", kMostSegments, "]"));
    std::string name = text_of(segment, DCM_SegmentLabel);
    const std::string meaning = code_meaning(segment, DCM_SegmentedPropertyTypeCodeSequence);
    if (!meaning.empty() && !absl::EqualsIgnoreCase(meaning, name)) absl::StrAppend(&name, " (", meaning, ")");
    header->names[number] = name;
  }
  if (header->names.empty()) return bad("has no segment in its SegmentSequence");
  return absl::OkStatus();
}

absl::Status take_format(DcmItem* data_set, SegmentationHeader* header) {
  header->rows = whole_number_of(data_set, DCM_Rows, 0);
  header->columns = whole_number_of(data_set, DCM_Columns, 0);
  for (const int64_t size : {header->rows, header->columns}) {
    if (size < 2 || size > kMostPixelsAlong)
      return bad(absl::StrCat("has ", header->columns, " x ", header->rows, " pixels, not in [2, ", kMostPixelsAlong,
                              "] each way"));
  }
  const std::string type = text_of(data_set, DCM_SegmentationType);
  header->bits = whole_number_of(data_set, DCM_BitsAllocated, 0);
  header->is_label_map = type == "LABELMAP";
  const bool fits = (type == "BINARY" && header->bits == 1) || (type == "FRACTIONAL" && header->bits == 8) ||
                    (header->is_label_map && (header->bits == 8 || header->bits == 16));
  if (!fits) {
    return bad(absl::StrCat("has SegmentationType \"", type, "\" of ", header->bits,
                            " bits a pixel, which is not BINARY of 1, FRACTIONAL of 8 or LABELMAP of 8 or 16"));
  }
  if (type == "FRACTIONAL") header->half = (whole_number_of(data_set, DCM_MaximumFractionalValue, 255) + 1) / 2;
  if (header->half < 1) return bad("has a MaximumFractionalValue that is not above 0");
  return absl::OkStatus();
}

/// Holds what the header claims against the length of the pixels, before memory is taken.
absl::Status check_length(DcmDataset* data_set, const std::filesystem::path& file, int64_t count,
                          SegmentationHeader* header) {
  DcmElement* pixels = nullptr;
  if (data_set->findAndGetElement(DCM_PixelData, pixels).bad() || pixels == nullptr) return bad("has no pixels");
  header->is_packed = DcmXfer(data_set->getOriginalXfer()).isEncapsulated();
  if (header->is_packed && header->bits == 1) {
    return bad(absl::StrCat("has packed pixels of 1 bit (", DcmXfer(data_set->getOriginalXfer()).getXferName(),
                            "): save it without compression"));
  }
  const int64_t bytes = (header->rows * header->columns * count * header->bits + 7) / 8;
  std::error_code error;
  const auto size = static_cast<int64_t>(std::filesystem::file_size(file, error));
  const int64_t held = header->is_packed ? kMaxRatio * size : static_cast<int64_t>(pixels->getLength());
  if (bytes <= held) return absl::OkStatus();
  return bad(absl::StrCat("is cut short or damaged: its header asks for ", bytes, " bytes of pixels, ", held,
                          header->is_packed ? " at most can be in it" : " are there"));
}

absl::Status take_axes(const FrameFields& fields, SegmentationHeader* header) {
  const auto axes = fields.numbers(DCM_PlaneOrientationSequence, DCM_ImageOrientationPatient, 6);
  const auto spacing = fields.numbers(DCM_PixelMeasuresSequence, DCM_PixelSpacing, 2);
  if (!axes) return bad("has no ImageOrientationPatient of six numbers, so it is not known where it lies");
  if (!spacing) return bad("has no PixelSpacing of two numbers");
  header->row = Vector3d((*axes)[0], (*axes)[1], (*axes)[2]);
  header->column = Vector3d((*axes)[3], (*axes)[4], (*axes)[5]);
  if (std::abs(header->row.norm() - 1.0) > 0.01 || std::abs(header->column.norm() - 1.0) > 0.01 ||
      std::abs(header->row.dot(header->column)) > 0.01)
    return bad("has an ImageOrientationPatient that is not two unit vectors at right angles");
  header->spacing = {(*spacing)[1], (*spacing)[0]};
  for (const double mm : header->spacing) {
    if (!(mm > 1e-3 && mm < 100.0)) return bad(absl::StrCat("has PixelSpacing ", mm, " mm, not in (0.001, 100)"));
  }
  const auto between = fields.numbers(DCM_PixelMeasuresSequence, DCM_SpacingBetweenSlices, 1);
  if (between && between->front() > 1e-3) header->between = between->front();
  return absl::OkStatus();
}

absl::StatusOr<SegmentFrame> read_frame_header(DcmItem* data_set, int64_t k, const SegmentationHeader& header) {
  const FrameFields fields(data_set, static_cast<unsigned long>(k));
  const auto position = fields.numbers(DCM_PlanePositionSequence, DCM_ImagePositionPatient, 3);
  if (!position) return bad(absl::StrCat("does not say where its frame ", k + 1, " lies (ImagePositionPatient)"));
  SegmentFrame frame{Vector3d((*position)[0], (*position)[1], (*position)[2]), 0};
  const auto axes = fields.numbers(DCM_PlaneOrientationSequence, DCM_ImageOrientationPatient, 6);
  if (axes && (Vector3d((*axes)[0], (*axes)[1], (*axes)[2]) - header.row).norm() +
                      (Vector3d((*axes)[3], (*axes)[4], (*axes)[5]) - header.column).norm() >
                  0.01)
    return bad(absl::StrCat("has frames of several orientations: frame ", k + 1, " is another than the first"));
  if (header.is_label_map) return frame;
  const auto segment = fields.numbers(DCM_SegmentIdentificationSequence, DCM_ReferencedSegmentNumber, 1);
  const double number = segment ? segment->front() : 0.0;
  if (number != std::floor(number) || number < 1.0 || header.names.count(static_cast<int64_t>(number)) == 0)
    return bad(absl::StrCat("does not say which of its segments frame ", k + 1, " shows (ReferencedSegmentNumber)"));
  frame.segment = static_cast<uint16_t>(number);
  return frame;
}

}  // namespace

absl::StatusOr<SegmentationHeader> read_segmentation_header(DcmDataset* data_set, const std::filesystem::path& file) {
  SegmentationHeader header;
  const int64_t count = whole_number_of(data_set, DCM_NumberOfFrames, 1);
  if (count < 1 || count > kMostFrames)
    return bad(absl::StrCat("has ", count, " frames, not in [1, ", kMostFrames, "]"));
  for (const auto& status : {take_format(data_set, &header), take_segments(data_set, &header)}) {
    if (!status.ok()) return status;
  }
  if (auto status = check_length(data_set, file, count, &header); !status.ok()) return status;
  if (auto status = take_axes(FrameFields(data_set, 0), &header); !status.ok()) return status;
  for (int64_t k = 0; k < count; ++k) {
    auto frame = read_frame_header(data_set, k, header);
    if (!frame.ok()) return frame.status();
    header.frames.push_back(*frame);
  }
  return header;
}

namespace {

/// The least distance between planes that are not the same.
double least_distance(std::vector<double> heights) {
  std::sort(heights.begin(), heights.end());
  double least = 0.0;
  for (size_t k = 1; k < heights.size(); ++k) {
    const double gap = heights[k] - heights[k - 1];
    if (gap > 1e-3 && (least == 0.0 || gap < least)) least = gap;
  }
  return least;
}

}  // namespace

absl::StatusOr<SegmentationPlanes> find_segmentation_planes(const SegmentationHeader& header) {
  const Vector3d normal = header.row.cross(header.column);
  std::vector<double> heights;
  for (const SegmentFrame& frame : header.frames) heights.push_back(normal.dot(frame.position));
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  const double between = header.between > 0.0 ? header.between : least_distance(heights);
  if (between == 0.0)
    return bad("has one plane alone and no SpacingBetweenSlices: a label map of a volume has several");
  const double steps = std::round((*high - *low) / between);
  if (!(steps < static_cast<double>(kMostPixelsAlong)))
    return bad(absl::StrCat("has planes ", *high - *low, " mm from each other in steps of ", between, " mm"));
  SegmentationPlanes planes;
  planes.first = header.frames[static_cast<size_t>(low - heights.begin())].position;
  const Vector3d last = header.frames[static_cast<size_t>(high - heights.begin())].position;
  planes.step = steps > 0.0 ? Vector3d((last - planes.first) / steps) : Vector3d(between * normal);
  planes.count = static_cast<int64_t>(steps) + 1;
  for (size_t k = 0; k < heights.size(); ++k) {
    const double plane = std::round((heights[k] - *low) / planes.step.dot(normal));
    const Vector3d off = header.frames[k].position - planes.first - plane * planes.step;
    if (!(off.norm() <= kOffGrid * between))
      return bad(absl::StrCat("has planes that are not spaced evenly: frame ", k + 1, " lies ", off.norm(),
                              " mm off a grid of ", between, " mm"));
  }
  return planes;
}

}  // namespace lipofill::client
