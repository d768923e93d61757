#pragma once

#include <vtkPolyData.h>

#include <cstdint>
#include <map>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/dicom/dicom_stack.h"

namespace lipofill::client {

/// A film of fat in the voxels of a series.
struct FatVoxels {
  /// Slices that hold fat, by their place in the stack: a byte a pixel, row by row, 1 where at
  /// least half of the voxel is fat.
  std::map<size_t, std::vector<uint8_t>> slices;
  double film_ml = 0.0;     ///< volume of the film
  double voxels_ml = 0.0;   ///< volume of the voxels that are labelled
  double outside_ml = 0.0;  ///< what of the film lies outside of the series
};

/// The share of a surface's points that lie outside of a series. Checked by
/// tests/unit/client/fat_voxels_test.cc.
/// @param surface  in LPS [mm]
double find_share_outside(vtkPolyData* surface, const DicomStack& stack);

/// Puts a film into the voxels of a series. Each cell is the space on both sides of its
/// quadrilateral, half its thickness along the normal n:
///
///     x(a, b, c) = q(a, b) + c h n(a, b),   0 <= a, b <= 1,  -1/2 <= c <= 1/2
///
/// It is cut into equal parts of less than half a voxel, whose volume goes to the voxel that holds
/// their middle: what is added up is the film's volume to round-off. Slices lie where they lie,
/// also unevenly. INVALID_ARGUMENT where more than a hundredth of the fat lies outside of the
/// series: then the plan was made in another frame. Checked by
/// tests/unit/client/fat_voxels_test.cc.
/// @param film  quadrilaterals in LPS [mm] with "thickness_mm"
absl::StatusOr<FatVoxels> find_fat_voxels(vtkPolyData* film, const DicomStack& stack);

}  // namespace lipofill::client
