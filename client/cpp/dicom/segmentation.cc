#include "client/cpp/dicom/segmentation.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <vtkPointData.h>
#include <vtkUnsignedShortArray.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/dicom/dicom_library.h"
#include "client/cpp/dicom/dicom_pixels.h"
#include "client/cpp/dicom/frame_fields.h"
#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

using Eigen::Vector3d;

constexpr int64_t kMostFrames = 100'000;
constexpr int64_t kMostPixelsAlong = 65'535;
/// A few frames far apart must not take memory for all that may lie between them.
constexpr uint64_t kFreeBytes = uint64_t{256} << 20;
constexpr uint64_t kMostPerByte = 100;
constexpr int64_t kMostSegments = 65'535;
/// Planes may lie off an even grid by this part of its spacing.
constexpr double kOffGrid = 0.1;
/// Packed frames shrink at most so far.
constexpr int64_t kMaxRatio = 1000;

/// A frame, where it lies and of which segment it is; 0: its pixels are numbers of segments.
struct Frame {
  Vector3d position;
  uint16_t segment = 0;
};

/// The header of a segmentation.
struct Header {
  int64_t rows = 0;
  int64_t columns = 0;
  int64_t bits = 0;
  int64_t half = 1;  ///< of fractional segmentations: half of the greatest value
  bool is_label_map = false;
  bool is_packed = false;
  Vector3d row, column;
  std::array<double, 2> spacing{};
  double between = 0.0;  ///< planes, as the header says; 0: it does not
  std::vector<Frame> frames;
  LabelNames names;
};

/// Planes lie here: plane k at first + k step.
struct Planes {
  Vector3d first, step;
  int64_t count = 0;
};

absl::Status bad(absl::string_view what) {
  return absl::InvalidArgumentError(what);
}

std::string code_meaning(DcmItem* segment, const DcmTagKey& sequence) {
  DcmItem* code = nullptr;
  return segment->findAndGetSequenceItem(sequence, code, 0).good() ? text_of(code, DCM_CodeMeaning) : "";
}

absl::Status take_segments(DcmItem* data_set, Header* header) {
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

absl::Status take_format(DcmItem* data_set, Header* header) {
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
absl::Status check_length(DcmDataset* data_set, const std::filesystem::path& file, int64_t count, Header* header) {
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

absl::Status take_axes(const FrameFields& fields, Header* header) {
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

absl::StatusOr<Frame> read_frame_header(DcmItem* data_set, int64_t k, const Header& header) {
  const FrameFields fields(data_set, static_cast<unsigned long>(k));
  const auto position = fields.numbers(DCM_PlanePositionSequence, DCM_ImagePositionPatient, 3);
  if (!position) return bad(absl::StrCat("does not say where its frame ", k + 1, " lies (ImagePositionPatient)"));
  Frame frame{Vector3d((*position)[0], (*position)[1], (*position)[2]), 0};
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

absl::StatusOr<Header> read_header(DcmDataset* data_set, const std::filesystem::path& file) {
  Header header;
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

absl::StatusOr<Planes> find_planes(const Header& header) {
  const Vector3d normal = header.row.cross(header.column);
  std::vector<double> heights;
  for (const Frame& frame : header.frames) heights.push_back(normal.dot(frame.position));
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  const double between = header.between > 0.0 ? header.between : least_distance(heights);
  if (between == 0.0)
    return bad("has one plane alone and no SpacingBetweenSlices: a label map of a volume has several");
  const double steps = std::round((*high - *low) / between);
  if (!(steps < static_cast<double>(kMostPixelsAlong)))
    return bad(absl::StrCat("has planes ", *high - *low, " mm from each other in steps of ", between, " mm"));
  Planes planes;
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

/// The pixels of frames, as segments.
class SegmentPixels {
 public:
  SegmentPixels(DcmDataset* data_set, const std::filesystem::path& file, const Header& header)
      : data_set_(data_set), header_(header) {
    frame_.file = file;
    frame_.rows = static_cast<uint32_t>(header.rows);
    frame_.columns = static_cast<uint32_t>(header.columns);
  }

  absl::Status prepare() {
    if (header_.bits != 1) return absl::OkStatus();
    const Uint8* bytes = nullptr;
    const Uint16* words = nullptr;
    unsigned long count = 0;
    if (data_set_->findAndGetUint8Array(DCM_PixelData, bytes, &count).good() && bytes != nullptr) {
      bits_.assign(bytes, bytes + count);
    } else if (data_set_->findAndGetUint16Array(DCM_PixelData, words, &count).good() && words != nullptr) {
      bits_.reserve(2 * count);
      for (unsigned long k = 0; k < count; ++k) {
        bits_.push_back(static_cast<uint8_t>(words[k] & 0xFF));
        bits_.push_back(static_cast<uint8_t>(words[k] >> 8));
      }
    }
    const auto needed = static_cast<uint64_t>(header_.rows * header_.columns) * header_.frames.size();
    if (8 * bits_.size() < needed) return bad("has pixels that cannot be read to their end");
    return absl::OkStatus();
  }

  /// Adds a frame to its plane.
  absl::Status draw(size_t k, uint16_t* plane, uint64_t* overlapping) {
    const auto count = static_cast<size_t>(header_.rows * header_.columns);
    const uint16_t segment = header_.frames[k].segment;
    const auto put = [&](size_t at, uint16_t value) {
      if (value == 0) return;
      if (plane[at] != 0 && plane[at] != value) ++*overlapping;
      plane[at] = std::max(plane[at], value);
    };
    if (header_.bits == 1) {
      const size_t first = k * count;
      for (size_t at = 0; at < count; ++at) {
        if ((bits_[(first + at) / 8] >> ((first + at) % 8) & 1) != 0) put(at, segment);
      }
      return absl::OkStatus();
    }
    frame_.number = static_cast<uint32_t>(k);
    std::vector<int32_t> pixels;
    if (auto status = reader_.read(frame_, &pixels); !status.ok()) return status;
    for (size_t at = 0; at < count; ++at) {
      const int32_t value = pixels[at];
      if (header_.is_label_map) {
        put(at, static_cast<uint16_t>(std::clamp(value, 0, 65'535)));
      } else if (value >= header_.half) {
        put(at, segment);
      }
    }
    return absl::OkStatus();
  }

 private:
  DcmDataset* data_set_;
  const Header& header_;
  std::vector<uint8_t> bits_;
  DicomFrame frame_;
  DicomPixels reader_;
};

absl::StatusOr<vtkSmartPointer<vtkImageData>> draw_frames(SegmentPixels* pixels, const Header& header,
                                                          const Planes& planes, uint64_t* overlapping) {
  const Vector3d normal = header.row.cross(header.column);
  const auto area = static_cast<size_t>(header.rows * header.columns);
  auto voxels = vtkSmartPointer<vtkImageData>::New();
  voxels->SetDimensions(static_cast<int>(header.columns), static_cast<int>(header.rows),
                        static_cast<int>(planes.count) + 2);
  voxels->AllocateScalars(VTK_UNSIGNED_SHORT, 1);
  auto* const labels = static_cast<uint16_t*>(voxels->GetScalarPointer());
  std::fill_n(labels, area * static_cast<size_t>(planes.count + 2), uint16_t{0});
  for (size_t k = 0; k < header.frames.size(); ++k) {
    const double height = normal.dot(header.frames[k].position - planes.first);
    const auto plane = static_cast<size_t>(std::llround(height / planes.step.dot(normal)));
    if (auto status = pixels->draw(k, labels + (plane + 1) * area, overlapping); !status.ok()) return status;
  }
  return voxels;
}

Affine map_of(const Header& header, const Planes& planes) {
  Affine map{};
  const Vector3d origin = planes.first - planes.step;
  for (int row = 0; row < 3; ++row) {
    const auto at = static_cast<size_t>(4 * row);
    map[at] = header.spacing[0] * header.row[row];
    map[at + 1] = header.spacing[1] * header.column[row];
    map[at + 2] = planes.step[row];
    map[at + 3] = origin[row];
  }
  map[15] = 1.0;
  return map;
}

absl::StatusOr<Volume> read(const std::filesystem::path& file) {
  prepare_dicom_library();
  DcmFileFormat format;
  if (format.loadFile(file.c_str()).bad()) return bad("is cut short or damaged");
  DcmDataset* const data_set = format.getDataset();
  auto header = read_header(data_set, file);
  if (!header.ok()) return header.status();
  const auto planes = find_planes(*header);
  if (!planes.ok()) return planes.status();
  const uint64_t bytes =
      uint64_t{2} * static_cast<uint64_t>(header->rows * header->columns) * static_cast<uint64_t>(planes->count + 2);
  std::error_code error;
  const uint64_t allowed =
      std::min(kMaxVolumeBytes, kFreeBytes + kMostPerByte * std::filesystem::file_size(file, error));
  if (bytes > allowed)
    return bad(
        absl::StrCat("spans ", planes->count, " planes, ", bytes, " bytes as a label map, must be at most ", allowed));
  SegmentPixels pixels(data_set, file, *header);
  if (auto status = pixels.prepare(); !status.ok()) return status;
  uint64_t overlapping = 0;
  auto voxels = draw_frames(&pixels, *header, *planes, &overlapping);
  if (!voxels.ok()) return voxels.status();
  Volume volume;
  volume.voxels = *voxels;
  volume.index_to_mm = map_of(*header, *planes);
  volume.frame = "LPS";
  volume.label_names = header->names;
  if (overlapping > 0) {
    volume.remarks.push_back(
        absl::StrCat(overlapping, " times two segments have the same voxel: the one of the higher number has it"));
  }
  return volume;
}

/// Reads what is in front of the pixels and of the segments' own attributes.
bool load_head(const std::filesystem::path& file, DcmFileFormat* format) {
  std::ifstream stream(file, std::ios::binary);
  std::array<char, 132> head{};
  stream.read(head.data(), head.size());
  if (stream.gcount() != 132 || std::string_view(head.data() + 128, 4) != "DICM") return false;
  prepare_dicom_library();
  return format->loadFileUntilTag(file.c_str(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength, ERM_autoDetect, DCM_Rows)
      .good();
}

}  // namespace

bool is_segmentation(const std::filesystem::path& file) {
  DcmFileFormat format;
  return load_head(file, &format) && text_of(format.getDataset(), DCM_Modality) == "SEG";
}

bool is_segmentation_of(const std::filesystem::path& file, const std::string& series) {
  DcmFileFormat format;
  if (!load_head(file, &format) || text_of(format.getDataset(), DCM_Modality) != "SEG") return false;
  return text_of(format.getDataset(), DCM_SeriesInstanceUID) == series ||
         text_of(format.getDataset(), DCM_SeriesNumber) == series;
}

absl::StatusOr<Volume> read_segmentation(const std::filesystem::path& file) {
  auto volume = read(file);
  if (volume.ok()) return volume;
  return bad_volume(file, absl::StrCat("is a segmentation that ", volume.status().message()));
}

}  // namespace lipofill::client
