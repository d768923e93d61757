// A glTF file, as GLB and as JSON: what is read is a surface within its own points.

#include <cmath>

#include "client/cpp/gltf/gltf_surface.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto file = lipofill::fuzz::write_scratch_file("surface.glb", lipofill::fuzz::as_text(data, size));
  const auto surface = lipofill::client::read_gltf_surface(file);
  if (!surface.ok()) return 0;
  lipofill::fuzz::require(!surface->triangles.empty(), "a surface has triangles");
  for (const auto& triangle : surface->triangles) {
    for (const uint32_t corner : triangle)
      lipofill::fuzz::require(corner < surface->points.size(), "corners are points of the surface");
  }
  for (const auto& point : surface->points) {
    for (const double coordinate : point) lipofill::fuzz::require(std::isfinite(coordinate), "points are finite");
  }
  lipofill::fuzz::require(surface->colours.empty() || surface->colours.size() == surface->points.size(),
                          "every point has a colour, or none has");
  (void)lipofill::client::ply_bytes(*surface, lipofill::client::gltf_unit_mm(*surface, 1.0));
  return 0;
}
