#pragma once

#include <filesystem>

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
  double slope = 1.0;  ///< value = slope * voxel + intercept
  double intercept = 0.0;
  VolumeHeader header;
};

absl::StatusOr<Volume> read_volume(const std::filesystem::path& file);

}  // namespace lipofill::client
