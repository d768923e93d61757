#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include "absl/status/statusor.h"
#include "client/cpp/volume/volume_header.h"

namespace lipofill::client {

/// Voxels on the grid of their indices (origin 0, spacing 1), and how to get from there to
/// millimetres and to the values meant.
struct Volume {
  vtkSmartPointer<vtkImageData> voxels;
  Affine index_to_mm{};
  /// Where slices are not spaced evenly, these are the millimetres of voxel (0, 0, k) of each.
  /// Between two slices a point goes straight from one to the other. Empty: index_to_mm says it
  /// all.
  std::vector<std::array<double, 3>> slice_origins;
  double slope = 1.0;  ///< value = slope * voxel + intercept
  double intercept = 0.0;
  std::string frame;       ///< "LPS" (x left, y back, z up), or "the file's own"
  LabelNames label_names;  ///< of a segmentation that names what its labels are
  std::vector<std::string> remarks;
};

/// The value of air in a CT [HU].
inline constexpr double kAirHu = -1000.0;

/// Reads a volume whose header read_volume_header accepts. A voxel that is not a number is air:
/// kAirHu, or the lowest value there is where that is lower. Takes memory for the voxels once.
/// Checked by tests/unit/client/volume_test.cc and volume_kinds_test.cc.
absl::StatusOr<Volume> read_volume(const std::filesystem::path& file);

}  // namespace lipofill::client
