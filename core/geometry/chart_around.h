#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/footprint.h"
#include "core/geometry/region_patch.h"
#include "core/geometry/surface_chart.h"

namespace lipofill::geometry {

/// This tells what ends at a vertex of the patch.
enum class SkinBorder { kNone, kFold, kScanEnd };

/// This is what an obstacle is called where layers fold under it.
inline constexpr char kSharpBend[] = "a bend of the skin too sharp for the layers";

/// A point that the model should keep clear of, and what is there ("the mouth").
struct Obstacle {
  std::string name;
  Eigen::Vector3d position;  ///< [m]
};

/// The request says what to chart: the footprints with a margin around them.
struct ChartAroundRequest {
  std::vector<Footprint> footprints;
  double margin = 0.0;  ///< [m] wanted on every side
  Eigen::Vector3d up;   ///< eta runs that way, as far as the rectangle allows
  std::vector<Obstacle> obstacles;
  std::vector<SkinBorder> border;  ///< a value a vertex of the patch
};

struct ChartAround {
  RegionChart chart;
  std::array<Eigen::Vector3d, 4> corners;  ///< on the skin [m]
  std::vector<std::string> remarks;        ///< what could not be had as asked, a sentence each
};

/// Charts a rectangle of the flattened patch: the smallest, of any direction, that holds the
/// footprints and the margin. A side gives up margin where a border of the skin or an obstacle
/// comes closer; where a border runs through a footprint, the side that loses least of it moves in.
/// INVALID_ARGUMENT with the footprint's field where less than 0.6 of one is left, saying what ends
/// there; FAILED_PRECONDITION for skin that folds over itself.
/// Checked by tests/unit/geometry/chart_around_test.cc.
absl::StatusOr<ChartAround> chart_around(const RegionPatch& patch, const ChartAroundRequest& request, int n_xi,
                                         int n_eta);

}  // namespace lipofill::geometry
