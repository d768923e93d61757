#pragma once

#include <string>
#include <vector>

#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// A copy of a scan fit for geometry: no degenerate or repeated triangles, no vertex twice, at most
/// two triangles an edge, triangles of a part agreeing on their direction, no specks.
struct CleanedSurface {
  SurfaceMesh mesh;
  std::vector<int> vertex_of_scan;   ///< vertex of `mesh` for each vertex of the scan, -1 where none
  std::vector<std::string> remarks;  ///< what was done, a sentence each, with counts
};

/// Cleans a scan. A speck is a part of less than 2 % of the area of the largest part. At an edge of
/// more than two triangles the two that continue each other most smoothly stay. Of a scan that was
/// thickened for print, or is hollow, the outer wall stays (outer_wall.h). The mesh may come out
/// empty. Deterministic.
/// Checked by tests/unit/geometry/surface_cleaning_test.cc and outer_wall_test.cc.
CleanedSurface clean_surface(const SurfaceMesh& scan);

}  // namespace lipofill::geometry
