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

#include "absl/strings/str_cat.h"
#include "client/cpp/dicom/dicom_library.h"
#include "client/cpp/dicom/dicom_pixels.h"
#include "client/cpp/dicom/frame_fields.h"
#include "client/cpp/dicom/segmentation_header.h"
#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

using Eigen::Vector3d;

/// A few frames far apart must not take memory for all that may lie between them.
constexpr uint64_t kFreeBytes = uint64_t{256} << 20;
constexpr uint64_t kMostPerByte = 100;

absl::Status bad(absl::string_view what) {
  return absl::InvalidArgumentError(what);
}

/// The pixels of frames, as segments.
class SegmentPixels {
 public:
  SegmentPixels(DcmDataset* data_set, const std::filesystem::path& file, const SegmentationHeader& header)
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
  const SegmentationHeader& header_;
  std::vector<uint8_t> bits_;
  DicomFrame frame_;
  DicomPixels reader_;
};

absl::StatusOr<vtkSmartPointer<vtkImageData>> draw_frames(SegmentPixels* pixels, const SegmentationHeader& header,
                                                          const SegmentationPlanes& planes, uint64_t* overlapping) {
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

Affine map_of(const SegmentationHeader& header, const SegmentationPlanes& planes) {
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
  auto header = read_segmentation_header(data_set, file);
  if (!header.ok()) return header.status();
  const auto planes = find_segmentation_planes(*header);
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
