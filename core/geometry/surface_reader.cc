#include "core/geometry/surface_reader.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/geometry/surface_builder.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

absl::StatusOr<ScannedSurface> parse(std::string_view bytes, SurfaceFormat format, const SurfaceLimits& limits) {
  switch (format) {
    case SurfaceFormat::kObj:
      return parse_obj(bytes, limits);
    case SurfaceFormat::kPly:
      return parse_ply(bytes, limits);
    case SurfaceFormat::kStl:
      return parse_stl(bytes, limits);
  }
  return absl::InvalidArgumentError("unknown surface format");
}

Eigen::Vector3d compute_extent(const SurfaceMesh& mesh) {
  return mesh.points.rowwise().maxCoeff() - mesh.points.rowwise().minCoeff();
}

absl::Status check_extent(const SurfaceMesh& mesh, double metres_per_unit, const SurfaceLimits& limits) {
  const double extent = compute_extent(mesh).maxCoeff();
  if (extent >= limits.min_extent_m && extent <= limits.max_extent_m) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("the surface is ", extent * 1e3, " mm across with ",
                                                 metres_per_unit * 1e3, " mm a unit of the file, must be in [",
                                                 limits.min_extent_m * 1e3, ", ", limits.max_extent_m * 1e3,
                                                 "] mm: is the unit right?"));
}

}  // namespace

absl::StatusOr<ScannedSurface> read_surface(std::string_view bytes, SurfaceFormat format, double metres_per_unit,
                                            const SurfaceLimits& limits) {
  if (!(metres_per_unit > 0.0) || !std::isfinite(metres_per_unit)) {
    return absl::InvalidArgumentError(absl::StrCat("metres per unit is ", metres_per_unit, ", must be above 0"));
  }
  if (bytes.empty()) return absl::InvalidArgumentError("the file is empty");
  if (bytes.size() > limits.max_bytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("the file has ", bytes.size(), " bytes, must be at most ", limits.max_bytes));
  }
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    return absl::InvalidArgumentError("the file is a text in UTF-16: save it as UTF-8 or plain ASCII");
  }
  auto mesh = parse(bytes, format, limits);
  if (!mesh.ok()) return mesh.status();
  mesh->points *= metres_per_unit;
  const absl::Status extent = check_extent(*mesh, metres_per_unit, limits);
  if (!extent.ok()) return extent;
  return mesh;
}

SurfaceCheck check_surface(const SurfaceMesh& mesh) {
  SurfaceCheck check;
  const TriangleNeighbours neighbours = find_neighbours(mesh);
  check.components = label_components(neighbours.across).count;
  check.boundary_loops = static_cast<int>(trace_boundary_loops(mesh, neighbours.across).size());
  check.non_manifold_edges = neighbours.non_manifold_edges;
  for (const auto& triangle : mesh.triangles) {
    if (is_degenerate(mesh, triangle)) ++check.degenerate_triangles;
  }
  if (mesh.n_vertices() > 0) check.extent = compute_extent(mesh);
  return check;
}

}  // namespace lipofill::geometry
