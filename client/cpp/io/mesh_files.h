#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cpp/arrays.h"

namespace lipofill::client {

/// One mesh at rest with fields on it. Points to the arrays it was made from.
struct MeshView {
  std::string name;               ///< "skin", "scan", "film/<film>", "tissue"
  const Array* points = nullptr;  ///< (n, 3) float32 or float64 [mm], at rest
  const Array* cells = nullptr;   ///< (n, 3 | 4 | 8) uint32
  std::vector<const Array*> fields;
};

/// The meshes among the arrays, in their order, each with its fields. DATA_LOSS for arrays that do
/// not fit together: points or cells missing, an index outside the points, a field of another
/// length.
absl::StatusOr<std::vector<MeshView>> mesh_views(std::span<const Array> meshes, std::span<const Array> fields);

/// The extension of the file a mesh is written to: ".vtu" for hexahedra, ".vtp" for triangles and
/// quadrilaterals.
const char* mesh_extension(const MeshView& mesh);

/// The name of a field in a file, its unit included: "displacement_mm", "pressure_pa",
/// "velocity_mm_per_s", "wet".
std::string field_name(const Array& field);

/// Writes a mesh for ParaView (XML, appended binary, zlib): the points at rest plus the field
/// "displacement", and all fields by `field_name`. Checked by tests/unit/client/mesh_files_test.cc.
absl::Status write_mesh(const std::filesystem::path& file, const MeshView& mesh);

/// Writes a ParaView collection: files, named relative to it, at their times.
absl::Status write_collection(const std::filesystem::path& file,
                              const std::vector<std::pair<double, std::string>>& time_and_file);

}  // namespace lipofill::client
