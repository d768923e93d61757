#pragma once

#include <array>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/dicom/dicom_frame.h"
#include "client/cpp/volume/volume_header.h"

namespace lipofill::client {

/// The images of a series as slices of one volume.
struct DicomStack {
  std::vector<DicomFrame> slices;  ///< by their position along the normal of the first
  Affine index_to_mm{};            ///< of voxel (column, row, slice); with tilt its axes are oblique
  /// The millimetres of voxel (0, 0, k) of each slice, where these are not spaced evenly.
  std::vector<std::array<double, 3>> slice_origins;
  double slice_spacing = 0.0;  ///< [mm] the median
  std::string orientation;     ///< "axial", "coronal", "sagittal" or "oblique"
  std::vector<std::string> remarks;
};

/// Orders the images of a series by where they lie:
///
///     n = row x column,   t_k = n . p_k,   slices sorted by t;   column 3 of the map = (p_last - p_first) / (N - 1)
///
/// so that a gantry that leans shears the volume as it should. Images that say they are localizers
/// are left out, copies of the same image too. Uneven spacing is kept as it is. INVALID_ARGUMENT,
/// without the file's name, where the images are not one volume: of several patients, orientations,
/// sizes or pixel spacings, two at the same place, fewer than two, one that cannot be read, or
/// slices missing between others, which `bridge_gaps` has crossed in a straight line. Checked by
/// tests/unit/client/dicom_series_test.cc.
absl::StatusOr<DicomStack> stack_slices(std::vector<DicomFrame> images, bool bridge_gaps);

}  // namespace lipofill::client
