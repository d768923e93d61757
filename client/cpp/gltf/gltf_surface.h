#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// The surface of a glTF file, all meshes of its scene where their nodes put them.
struct ColouredSurface {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<std::array<uint8_t, 3>> colours;  ///< of the points, as screens show them; empty: none
  std::vector<std::string> remarks;             ///< what was passed over, a sentence each
};

/// Tells whether a file's ending is .glb or .gltf.
bool is_gltf_name(const std::filesystem::path& file);

/// Reads a .glb or .gltf: triangles, strips and fans, with or without indices, and the colours of
/// vertices. Textures, skins and morph targets are passed over with a remark. Coordinates are those
/// of the file, in metres by the format and with y up. INVALID_ARGUMENT, naming the file, for what
/// is damaged, holds no triangle, or is packed. Checked by tests/unit/client/gltf_test.cc and
/// tests/fuzz/gltf_fuzzer.cc.
absl::StatusOr<ColouredSurface> read_gltf_surface(const std::filesystem::path& file);

/// A surface as a binary PLY with double coordinates, times `scale`, and its colours where it has
/// some. The same surface gives the same bytes.
std::string ply_bytes(const ColouredSurface& surface, double scale);

/// Millimetres a unit of a glTF surface. The format has metres; many programs write whatever their
/// scanner had. A surface smaller than 5 units is taken for metres, a larger one as `stated_mm`.
double gltf_unit_mm(const ColouredSurface& surface, double stated_mm);

}  // namespace lipofill::client
