#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

enum class SurfaceFormat { kObj, kPly, kStl };

/// Bounds on what is accepted.
struct SurfaceLimits {
  size_t max_bytes = size_t{256} << 20;
  int max_vertices = 5'000'000;
  int max_triangles = 10'000'000;
  double max_extent_m = 3.0;  ///< a larger scan is in the wrong unit
  double min_extent_m = 0.02;
};

/// Properties of a surface before any cleaning.
struct SurfaceCheck {
  int components = 0;
  int boundary_loops = 0;
  int non_manifold_edges = 0;
  int degenerate_triangles = 0;
  Eigen::Vector3d extent = Eigen::Vector3d::Zero();  ///< [m]
};

/// Red, green and blue from 0 to 255, as screens show them.
using Rgb8 = std::array<uint8_t, 3>;

/// A surface as a file has it, and what of the file is not in it.
struct ScannedSurface : SurfaceMesh {
  std::vector<Rgb8> colours;  ///< one a vertex; empty where the file has none
  /// The remarks say what was passed over, left out or read in spite of a fault, a sentence each,
  /// with counts.
  std::vector<std::string> remarks;
};

/// Reads a surface from the bytes of a file: OBJ (polygons, texture coordinates and normals
/// ignored), PLY (ASCII, binary little and big endian; faces and triangle strips), STL (ASCII with
/// any number of solids, binary; equal points are merged). Lines end with LF, CR LF or CR; a byte
/// order mark of UTF-8 counts for nothing. Polygons are cut into triangles inside them; faces of
/// fewer than three corners and vertices of no face are left out, the others keep their order.
/// Colours of vertices are kept: red, green and blue of PLY, and of OBJ what follows x, y and z
/// ("v x y z r g b"), from 0 to 1 or to 255.
/// @param metres_per_unit  0.001 for a file in millimetres
/// INVALID_ARGUMENT, saying where in the file and what was found there, for a file that is empty,
/// cut short, of another format, has faces of vertices that are not finite or not there, has no
/// triangle, or is outside the limits. Never throws, never reserves more memory than a small
/// multiple of the file's own size. Checked by tests/unit/geometry/surface_reader_test.cc,
/// tests/unit/geometry/surface_kinds_test.cc and tests/unit/geometry/surface_colours_test.cc.
absl::StatusOr<ScannedSurface> read_surface(std::string_view bytes, SurfaceFormat format, double metres_per_unit,
                                            const SurfaceLimits& limits = {});

SurfaceCheck check_surface(const SurfaceMesh& mesh);

}  // namespace lipofill::geometry
