#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::geometry {

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat32, kFloat64 };

size_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  ///< a list states its length in it
  PlyType type = PlyType::kFloat32;      ///< the value has it, or each item of the list
};

struct PlyElement {
  std::string name;
  unsigned long long count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  size_t body_offset = 0;  ///< [bytes]
  size_t body_line = 0;    ///< lines before the body
  size_t unknown_lines = 0;
};

/// The header of a PLY file, without a byte order mark before it. Lines of unknown keywords are
/// counted. The body begins behind the end of the line of end_header, which is a CR alone where the
/// first line ends so: what follows may then be a byte of the body that looks like LF. Every
/// element's count is checked against the bytes that follow, so that no count can make a reader
/// loop or reserve beyond the file.
absl::StatusOr<PlyHeader> parse_ply_header(std::string_view bytes);

}  // namespace lipofill::geometry
