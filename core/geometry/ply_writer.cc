#include "core/geometry/ply_writer.h"

#include <cstdint>

#include "absl/strings/str_cat.h"

namespace lipofill::geometry {
namespace {

/// Processors that the program runs on have the order of bytes that the header promises.
template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

}  // namespace

std::string write_ply(const SurfaceMesh& mesh) {
  std::string bytes = absl::StrCat("ply\nformat binary_little_endian 1.0\nelement vertex ", mesh.n_vertices(),
                                   "\nproperty double x\nproperty double y\nproperty double z\nelement face ",
                                   mesh.n_triangles(), "\nproperty list uchar int vertex_indices\nend_header\n");
  constexpr size_t kBytesOfVertex = 24, kBytesOfTriangle = 13;
  bytes.reserve(bytes.size() + kBytesOfVertex * mesh.points.cols() + kBytesOfTriangle * mesh.triangles.size());
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    for (int c = 0; c < 3; ++c) append(bytes, mesh.points(c, v));
  }
  for (const auto& triangle : mesh.triangles) {
    append(bytes, uint8_t{3});
    for (const int corner : triangle) append(bytes, static_cast<int32_t>(corner));
  }
  return bytes;
}

}  // namespace lipofill::geometry
