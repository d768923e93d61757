#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::planning {

/// The outer skin of a scan, as it is registered and compared: cleaned, right side out, without the
/// walls of mouth, nostrils and whatever else lies inside.
struct SkinSurface {
  geometry::SurfaceMesh mesh;
  Eigen::Matrix3Xd normals;      ///< of the vertices, unit  (3, n_vertices)
  std::vector<int> scan_vertex;  ///< of each vertex of `mesh`, the first of the scan that is there
  std::vector<bool> is_border;   ///< of each triangle: it has a vertex on the border of the skin
  Eigen::Matrix3Xd rim;          ///< vertices of the scan's rim [m]
  double area = 0.0;             ///< [m2]
  bool was_inside_out = false;
};

/// The vertices of a scan's rim: its borders that are longer than 200 mm. Lips and eyes that are
/// open have shorter ones [m].
Eigen::Matrix3Xd find_rim(const geometry::SurfaceMesh& cleaned);

/// The part of a skin that is made of some of its triangles (ascending). Its border triangles are
/// those that were on the border of the whole.
SkinSurface extract_part(const SkinSurface& skin, const std::vector<int>& triangles);

/// Takes the skin of a scan. INVALID_ARGUMENT for a surface without skin; `name`
/// says in the message which it is. Checked by tests/unit/planning/skin_surface_test.cc.
absl::StatusOr<SkinSurface> extract_skin(const geometry::SurfaceMesh& scan, const std::string& name);

}  // namespace lipofill::planning
