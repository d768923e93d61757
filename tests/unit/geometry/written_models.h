#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/geometry/surface_reader.h"

namespace lipofill::geometry {

inline constexpr std::array<std::array<double, 3>, 8> kCube = {{{-50, -50, -50},
                                                                {50, -50, -50},
                                                                {50, 50, -50},
                                                                {-50, 50, -50},
                                                                {-50, -50, 50},
                                                                {50, -50, 50},
                                                                {50, 50, 50},
                                                                {-50, 50, 50}}};
inline constexpr std::array<std::array<int, 4>, 6> kSides = {
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

using Face = std::vector<int>;

/// Vertices and faces to be written in every format.
struct Model {
  std::vector<std::array<double, 3>> vertices{kCube.begin(), kCube.end()};
  std::vector<Face> faces;

  static Model cube() {
    Model model;
    for (const auto& [a, b, c, d] : kSides) {
      model.faces.push_back({a, b, c});
      model.faces.push_back({a, c, d});
    }
    return model;
  }
};

inline std::string to_obj(const Model& model) {
  std::string text = "# cube\nmtllib a.mtl\n";
  for (const auto& v : model.vertices) absl::StrAppend(&text, "v ", absl::StrJoin(v, " "), "\n");
  for (const Face& face : model.faces) {
    text += "f";
    for (const int corner : face) absl::StrAppend(&text, " ", corner + 1);
    text += "\n";
  }
  return text;
}

inline std::string ply_header(const Model& model, const char* format, const char* list = "uchar int") {
  return absl::StrCat("ply\nformat ", format, " 1.0\nelement vertex ", model.vertices.size(),
                      "\nproperty double x\nproperty double y\nproperty double z\nelement face ", model.faces.size(),
                      "\nproperty list ", list, " vertex_indices\nend_header\n");
}

inline std::string to_text_ply(const Model& model) {
  std::string text = ply_header(model, "ascii");
  for (const auto& v : model.vertices) absl::StrAppend(&text, absl::StrJoin(v, " "), "\n");
  for (const Face& face : model.faces) absl::StrAppend(&text, face.size(), " ", absl::StrJoin(face, " "), "\n");
  return text;
}

template <typename T>
void append(std::string& bytes, T value, bool big_endian = false) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (big_endian) std::reverse(raw, raw + sizeof raw);
  bytes.append(raw, sizeof raw);
}

template <typename Index>
std::string to_binary_ply(const Model& model, const char* type, bool big_endian = false) {
  std::string bytes = ply_header(model, big_endian ? "binary_big_endian" : "binary_little_endian",
                                 absl::StrCat("uchar ", type).c_str());
  for (const auto& v : model.vertices) {
    for (const double x : v) append(bytes, x, big_endian);
  }
  for (const Face& face : model.faces) {
    append(bytes, static_cast<uint8_t>(face.size()));
    for (const int corner : face) append(bytes, static_cast<Index>(corner), big_endian);
  }
  return bytes;
}

inline std::string to_text_stl(const Model& model) {
  std::string text = "solid cube\n";
  for (const Face& face : model.faces) {
    text += "facet normal 0 0 1\n  outer loop\n";
    for (const int corner : face)
      absl::StrAppend(&text, "    vertex ", absl::StrJoin(model.vertices[corner], " "), "\n");
    text += "  endloop\nendfacet\n";
  }
  return text + "endsolid cube\n";
}

inline std::string to_binary_stl(const Model& model, std::string header = "made for a test") {
  header.resize(80, ' ');
  append(header, static_cast<uint32_t>(model.faces.size()));
  for (const Face& face : model.faces) {
    header.append(12, '\0');
    for (const int corner : face) {
      for (const double x : model.vertices[corner]) append(header, static_cast<float>(x));
    }
    header.append(2, '\0');
  }
  return header;
}

struct Written {
  SurfaceFormat format;
  std::string bytes;
};

inline std::vector<Written> in_text_formats(const Model& model) {
  return {{SurfaceFormat::kObj, to_obj(model)},
          {SurfaceFormat::kPly, to_text_ply(model)},
          {SurfaceFormat::kStl, to_text_stl(model)}};
}

inline std::vector<Written> in_indexed_formats(const Model& model) {
  return {{SurfaceFormat::kObj, to_obj(model)},
          {SurfaceFormat::kPly, to_text_ply(model)},
          {SurfaceFormat::kPly, to_binary_ply<int32_t>(model, "int")},
          {SurfaceFormat::kPly, to_binary_ply<int32_t>(model, "int", true)}};
}

}  // namespace lipofill::geometry
