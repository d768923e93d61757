#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/surface_locator.h"
#include "core/geometry/surface_mesh.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {

/// Flags of the vertices on a border of a surface.
std::vector<bool> find_border_vertices(const SurfaceMesh& mesh);

/// Tells whether points lie beyond a border of a surface.
class BorderFinder {
 public:
  explicit BorderFinder(const SurfaceMesh& surface);

  /// True when the nearest place of a point is on a border and the point is off to its side, by
  /// more than 0.5 mm.
  bool is_beyond(const Eigen::Vector3d& point, const SurfacePoint& nearest) const;

 private:
  bool is_on_border(const SurfacePoint& place) const;

  const SurfaceMesh& surface_;
  Across across_;
  std::vector<bool> is_border_vertex_;
};

}  // namespace lipofill::geometry
