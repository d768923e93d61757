#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/chart_around.h"
#include "core/geometry/footprint_samples.h"

namespace lipofill::geometry {

/// A point to keep clear of, on the patch.
struct PlacedObstacle {
  std::string name;
  Eigen::Vector3d position;
  Eigen::Vector2d flat;
  bool may_cut = false;
};

/// A patch brought to the plane with its footprints.
struct FlatPatch {
  Eigen::Matrix2Xd flat;
  double scale = 1.0;  ///< lengths in the plane over lengths on the skin, around the footprints
  std::vector<Eigen::Vector2d> outline;
  std::vector<Eigen::Vector2d> content;
  std::vector<PlacedObstacle> obstacles;
  Eigen::Vector2d up;
};

using Samples = std::vector<std::vector<FootprintSample>>;

/// Two vertices at the ends of the longest footprint, or as far apart as the patch allows: the map
/// is truest between them.
std::pair<int, int> choose_pins(const SurfaceMesh& mesh, const std::vector<Footprint>& footprints);

/// Places what the request names in the plane of a map of the patch.
FlatPatch place_in_flat(const RegionPatch& region, const ChartAroundRequest& request, const SkinReach& reach,
                        const Samples& samples, Eigen::Matrix2Xd flat);

}  // namespace lipofill::geometry
