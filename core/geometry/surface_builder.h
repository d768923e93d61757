#pragma once

#include <array>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/geometry/surface_mesh.h"
#include "core/geometry/surface_reader.h"

namespace lipofill::geometry {

/// Gathers the vertices and polygons of a file as they are read, within bounds. `where` in every
/// call is the place in the file that an error names ("line 12"). Coordinates are in the file's
/// unit.
class SurfaceBuilder {
 public:
  explicit SurfaceBuilder(const SurfaceLimits& limits) : limits_(limits) {}

  absl::Status add_vertex(const std::array<double, 3>& xyz, const std::string& where);

  /// A polygon, cut into a fan of triangles from its first corner. Corners may name vertices still
  /// to come; build() checks them.
  absl::Status add_polygon(const std::vector<long long>& corners, const std::string& where);

  long long n_vertices() const { return static_cast<long long>(coordinates_.size() / 3); }

  /// Finishes at the end of the file: checks every corner, and that there is a triangle.
  absl::StatusOr<SurfaceMesh> build() &&;

 private:
  SurfaceLimits limits_;
  std::vector<double> coordinates_;
  std::vector<std::array<int, 3>> triangles_;
};

/// The parsers behind read_surface; they leave units and extent to it.
absl::StatusOr<SurfaceMesh> parse_obj(std::string_view bytes, const SurfaceLimits& limits);
absl::StatusOr<SurfaceMesh> parse_ply(std::string_view bytes, const SurfaceLimits& limits);
absl::StatusOr<SurfaceMesh> parse_stl(std::string_view bytes, const SurfaceLimits& limits);

}  // namespace lipofill::geometry
