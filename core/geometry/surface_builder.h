#pragma once

#include <array>
#include <string>
#include <utility>
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

  /// A vertex. Its coordinates need to be finite only where a face uses it, which build() checks.
  absl::Status add_vertex(const std::array<double, 3>& xyz, const std::string& where);

  /// The colour of the vertex that was added last: red, green and blue in the file's own numbers.
  void add_colour(const std::array<double, 3>& rgb);

  /// The number that is the brightest in the file. Where none is given it is 255 if more than one
  /// colour in a hundred is above 2, else 1: a few that are too bright must not darken the others.
  void set_brightest(double value) { brightest_ = value; }

  /// A polygon, to be cut into triangles at the end. Corners may name vertices still to come;
  /// build() checks them. One of fewer than three corners is left out and counted.
  absl::Status add_polygon(const std::vector<long long>& corners, const std::string& where);

  /// A sentence about what of the file is not in the surface.
  void add_remark(std::string remark) { remarks_.push_back(std::move(remark)); }

  long long n_vertices() const { return static_cast<long long>(coordinates_.size() / 3); }

  /// Finishes at the end of the file: checks every corner, and that there is a triangle; cuts
  /// polygons into triangles and leaves out vertices of no face.
  absl::StatusOr<ScannedSurface> build() &&;

 private:
  /// A polygon of more than three corners, kept as the fan of its triangles.
  struct Fan {
    size_t first_triangle = 0;
    size_t corners = 0;
  };

  absl::Status check_corners() const;
  absl::Status check_used_vertices(const std::vector<bool>& used) const;
  std::vector<bool> find_used() const;
  absl::Status cut_polygons(const SurfaceMesh& vertices);
  void take_colours(const std::vector<bool>& used, ScannedSurface& mesh);
  void leave_out_unused(const std::vector<bool>& used, ScannedSurface& mesh);

  SurfaceLimits limits_;
  std::vector<double> coordinates_;
  std::vector<std::array<float, 3>> colours_;  ///< of the first vertices; NaN where one has none
  double brightest_ = 0.0;                     ///< 0: not given
  std::vector<std::array<int, 3>> triangles_;
  std::vector<Fan> fans_;
  /// The first vertices that are not finite, and where they are.
  std::vector<std::pair<size_t, std::string>> not_finite_;
  size_t short_faces_ = 0;
  std::vector<std::string> remarks_;
};

/// "1 face", "2 faces".
std::string count_of(size_t n, const char* singular, const char* plural);

/// The parsers behind read_surface; they leave units and extent to it.
absl::StatusOr<ScannedSurface> parse_obj(std::string_view bytes, const SurfaceLimits& limits);
absl::StatusOr<ScannedSurface> parse_ply(std::string_view bytes, const SurfaceLimits& limits);
absl::StatusOr<ScannedSurface> parse_stl(std::string_view bytes, const SurfaceLimits& limits);

}  // namespace lipofill::geometry
