#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/volume/volume_reader.h"

class DcmDataset;

namespace lipofill::client {

/// A frame, where it lies and of which segment it is; 0: its pixels are numbers of segments.
struct SegmentFrame {
  Eigen::Vector3d position;
  uint16_t segment = 0;
};

/// The header of a segmentation.
struct SegmentationHeader {
  int64_t rows = 0;
  int64_t columns = 0;
  int64_t bits = 0;
  int64_t half = 1;  ///< of fractional segmentations: half of the greatest value
  bool is_label_map = false;
  bool is_packed = false;
  Eigen::Vector3d row, column;
  std::array<double, 2> spacing{};
  double between = 0.0;  ///< planes, as the header says; 0: it does not
  std::vector<SegmentFrame> frames;
  LabelNames names;
};

/// Planes lie here: plane k at first + k step.
struct SegmentationPlanes {
  Eigen::Vector3d first, step;
  int64_t count = 0;
};

/// Reads what a segmentation says of itself: its format, segments, axes and where each frame lies.
///
/// @return InvalidArgument for a header that a volume of labels cannot be made of, or that claims
/// more pixels than the file can hold; the message goes on after "is a segmentation that". Checked
/// by tests/unit/client/segmentation_test.cc.
absl::StatusOr<SegmentationHeader> read_segmentation_header(DcmDataset* data_set, const std::filesystem::path& file);

/// Finds the even stack of planes that all frames lie on; where the header does not say how far
/// they are apart, that is the least distance of two.
///
/// @return InvalidArgument where there is one plane alone or the planes are not evenly spaced.
absl::StatusOr<SegmentationPlanes> find_segmentation_planes(const SegmentationHeader& header);

}  // namespace lipofill::client
