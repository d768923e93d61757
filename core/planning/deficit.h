#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/geometry/head_axes.h"
#include "core/geometry/surface_distance.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::planning {

/// This is what a region of the face lacks to its target.
struct RegionDeficit {
  std::string region;  ///< empty for all
  double area = 0.0;   ///< [m2]
  geometry::VolumeBetween volume;
  geometry::DistanceStatistics distance;  ///< from the skin to the target, a value a vertex
  double max_deficit = 0.0;               ///< the target lies this far outside where it is farthest outside [m]
  int vertices = 0;
};

/// The deficit is what a face lacks to its target, before anything is simulated.
struct Deficit {
  RegionDeficit all;
  std::vector<RegionDeficit> regions;  ///< by name; those with skin that is compared
  geometry::DistanceStatistics target_to_skin;
  double hausdorff = 0.0;                ///< the larger of the two maxima [m]
  std::vector<double> distances;         ///< signed, a value a vertex of the scan; not a number where not compared [m]
  std::optional<double> symmetry_index;  ///< as in SymmetryPlane [m]
  std::vector<std::string> remarks;      ///< what is unusual, a sentence each
};

/// The task says what to compare with what.
struct DeficitTask {
  const geometry::SurfaceMesh& scan;
  const geometry::SurfaceMesh& target;   ///< in the frame of the scan
  const geometry::Landmarks& landmarks;  ///< of the scan; may be empty
  double rim_width = 0.0;                ///< skin this near to where scan or target end is left out [m]
};

/// Measures the deficit: signed distances from the scan's outer skin to the target's, positive
/// where the skin lies outside, and the volume between them by region. With landmarks it is the
/// skin in the ball around the face that counts. A triangle belongs to a region when its middle
/// does, within 30 mm of the region's centre along the skin's normal. INVALID_ARGUMENT for surfaces
/// without skin, FAILED_PRECONDITION where nothing is left to compare, CANCELLED. Checked by
/// tests/unit/planning/deficit_test.cc on shapes of known volume and on the shared patient, whose
/// missing volume is known.
absl::StatusOr<Deficit> measure_deficit(const DeficitTask& task, const Unwanted& unwanted = nullptr);

}  // namespace lipofill::planning
