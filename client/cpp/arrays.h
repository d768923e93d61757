#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lipofill::client {

enum class ElementType { kFloat32, kUint32, kUint8, kFloat64 };
enum class ArrayLocation { kMesh, kPoint, kCell };

size_t element_size(ElementType type);

/// One whole array of a mesh or a frame: C order, little-endian.
struct Array {
  std::string name;  ///< "<mesh>.<field>", for example "film/deep.pressure"
  std::string unit;  ///< "mm", "Pa", "mm/s", or empty
  ArrayLocation location = ArrayLocation::kMesh;
  ElementType type = ElementType::kFloat32;
  std::vector<size_t> shape;
  std::vector<std::byte> bytes;
  double max_error = 0.0;  ///< how far a value may be from what the daemon computed, where it came as a code

  std::string_view mesh() const;
  std::string_view field() const;
  size_t rows() const { return shape.empty() ? 0 : shape[0]; }
  /// Number of values a row: 1 for shape (n), 3 for (n, 3).
  size_t columns() const { return shape.size() < 2 ? 1 : shape[1]; }

  /// The values in place, without a copy. Precondition: type is the one named.
  std::span<const float> floats() const;
  std::span<const uint32_t> uint32s() const;
  std::span<const uint8_t> uint8s() const;
  std::span<const double> doubles() const;

  /// Points are in single precision, or in double precision where they lie far from the origin.
  bool has_points() const { return type == ElementType::kFloat32 || type == ElementType::kFloat64; }
  /// The values of points in double precision. Precondition: has_points().
  std::vector<double> to_doubles() const;
};

/// The array of this name; nullptr when there is none.
const Array* find_array(std::span<const Array> arrays, std::string_view name);

}  // namespace lipofill::client
