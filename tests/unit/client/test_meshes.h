#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "client/cpp/arrays.h"

namespace lipofill::client {

template <typename T>
Array make_array(const std::string& name, const std::string& unit, ArrayLocation location, ElementType type,
                 std::vector<size_t> shape, const std::vector<T>& values) {
  Array array{name, unit, location, type, std::move(shape), {}};
  array.bytes.resize(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(array.bytes.data(), values.data(), array.bytes.size());
  return array;
}

inline Array float_field(const std::string& name, const std::string& unit, ArrayLocation location, size_t rows,
                         size_t columns, const std::vector<float>& values) {
  return make_array(name, unit, location, ElementType::kFloat32,
                    columns == 1 ? std::vector<size_t>{rows} : std::vector<size_t>{rows, columns}, values);
}

/// A unit square of two triangles under the name of a mesh: points and cells.
inline std::vector<Array> square_mesh(const std::string& mesh) {
  return {make_array<float>(mesh + ".points", "mm", ArrayLocation::kMesh, ElementType::kFloat32, {4, 3},
                            {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}),
          make_array<uint32_t>(mesh + ".cells", "", ArrayLocation::kMesh, ElementType::kUint32, {2, 3},
                               {0, 1, 2, 0, 2, 3})};
}

/// A unit cube: one hexahedron.
inline std::vector<Array> cube_mesh() {
  return {make_array<float>("tissue.points", "mm", ArrayLocation::kMesh, ElementType::kFloat32, {8, 3},
                            {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1}),
          make_array<uint32_t>("tissue.cells", "", ArrayLocation::kMesh, ElementType::kUint32, {1, 8},
                               {0, 1, 2, 3, 4, 5, 6, 7})};
}

}  // namespace lipofill::client
