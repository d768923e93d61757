#include "tests/bench/service/refined_scan.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lipofill::bench {
namespace {

using geometry::SurfaceMesh;

constexpr double kMillimetresPerMetre = 1e3;

template <typename Number>
void put(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

void put_point(std::string& bytes, const SurfaceMesh& mesh, int vertex) {
  for (int c = 0; c < 3; ++c) put(bytes, static_cast<float>(mesh.points(c, vertex) * kMillimetresPerMetre));
}

std::string write_obj(const SurfaceMesh& mesh) {
  std::string text;
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    const Eigen::Vector3d p = mesh.points.col(v) * kMillimetresPerMetre;
    absl::StrAppendFormat(&text, "v %.6f %.6f %.6f\n", p.x(), p.y(), p.z());
  }
  for (const auto& [a, b, c] : mesh.triangles) absl::StrAppend(&text, "f ", a + 1, " ", b + 1, " ", c + 1, "\n");
  return text;
}

std::string write_ply(const SurfaceMesh& mesh) {
  std::string bytes = absl::StrCat("ply\nformat binary_little_endian 1.0\nelement vertex ", mesh.n_vertices(),
                                   "\nproperty float x\nproperty float y\nproperty float z\nelement face ",
                                   mesh.n_triangles(), "\nproperty list uchar int vertex_indices\nend_header\n");
  for (int v = 0; v < mesh.n_vertices(); ++v) put_point(bytes, mesh, v);
  for (const auto& triangle : mesh.triangles) {
    put(bytes, uint8_t{3});
    for (const int v : triangle) put(bytes, static_cast<int32_t>(v));
  }
  return bytes;
}

std::string write_stl(const SurfaceMesh& mesh) {
  std::string bytes(80, ' ');
  put(bytes, static_cast<uint32_t>(mesh.n_triangles()));
  for (const auto& triangle : mesh.triangles) {
    bytes.append(3 * sizeof(float), '\0');
    for (const int v : triangle) put_point(bytes, mesh, v);
    put(bytes, uint16_t{0});
  }
  return bytes;
}

}  // namespace

SurfaceMesh refine(const SurfaceMesh& mesh) {
  std::map<std::pair<int, int>, int> middles;
  std::vector<Eigen::Vector3d> added;
  const auto middle = [&](int a, int b) {
    const auto [entry, is_new] =
        middles.try_emplace(std::minmax(a, b), mesh.n_vertices() + static_cast<int>(added.size()));
    if (is_new) added.push_back(0.5 * (mesh.points.col(a) + mesh.points.col(b)));
    return entry->second;
  };
  SurfaceMesh fine;
  for (const auto& [a, b, c] : mesh.triangles) {
    const int ab = middle(a, b);
    const int bc = middle(b, c);
    const int ca = middle(c, a);
    for (const auto& triangle : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
      fine.triangles.push_back(triangle);
    }
  }
  fine.points.resize(3, mesh.n_vertices() + static_cast<Eigen::Index>(added.size()));
  fine.points.leftCols(mesh.n_vertices()) = mesh.points;
  for (size_t k = 0; k < added.size(); ++k) {
    fine.points.col(mesh.n_vertices() + static_cast<Eigen::Index>(k)) = added[k];
  }
  return fine;
}

std::string write_scan(const SurfaceMesh& mesh, geometry::SurfaceFormat format) {
  switch (format) {
    case geometry::SurfaceFormat::kPly:
      return write_ply(mesh);
    case geometry::SurfaceFormat::kStl:
      return write_stl(mesh);
    case geometry::SurfaceFormat::kObj:
      break;
  }
  return write_obj(mesh);
}

}  // namespace lipofill::bench
