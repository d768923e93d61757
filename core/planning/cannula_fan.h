#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "core/geometry/face_geometry.h"

namespace lipofill::planning {

/// A fan says how a zone is worked through from one entry: its cells seen from above, and in
/// tunnels that fan out. Checked by tests/unit/planning/delivery_test.cc.

/// A cell of a zone, seen from above: along the length of the zone, and across it.
struct ZoneCell {
  geometry::ChartPoint place;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double area = 0.0;
  Eigen::Vector2d seen = Eigen::Vector2d::Zero();
  double radius = 0.0;  ///< from the entry
  double angle = 0.0;   ///< of the fan
};

/// Sees the cells of a zone along its length and across it, the lower end first.
/// @param up  of the face
void look_from_above(const Eigen::Vector3d& up, std::vector<ZoneCell>& cells);

/// The cells of each tunnel, from the far end on; tunnels without a cell are left out.
/// @param spacing  of tunnels at the far end, at most [m]
std::vector<std::vector<ZoneCell>> lay_fan(const std::vector<ZoneCell>& cells, double spacing);

/// Chooses where fat is laid along a tunnel, and the area of the zone that each place serves [m2].
std::vector<std::pair<ZoneCell, double>> choose_places(const std::vector<ZoneCell>& tunnel, int most);

double sum_areas(const std::vector<ZoneCell>& cells);

}  // namespace lipofill::planning
