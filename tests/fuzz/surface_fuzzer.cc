// Scans as they come from outside: the first byte picks the format, the rest is the file.

#include "core/geometry/surface_reader.h"
#include "tests/fuzz/target.h"

using lipofill::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const auto format = static_cast<lipofill::geometry::SurfaceFormat>(data[0] % 3);
  const auto surface = lipofill::geometry::read_surface(lipofill::fuzz::as_text(data + 1, size - 1), format, 1e-3);
  if (!surface.ok()) return 0;
  require(surface->n_triangles() > 0, "a surface has triangles");
  require(surface->points.allFinite(), "points are finite");
  for (const auto& triangle : surface->triangles) {
    for (const int vertex : triangle) require(vertex >= 0 && vertex < surface->n_vertices(), "indices are in range");
  }
  lipofill::geometry::check_surface(*surface);
  return 0;
}
