#include "client/cpp/scene/ply_colours.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

constexpr size_t kMaxProperties = 64;
constexpr std::array<const char*, 6> kWanted = {"x", "y", "z", "red", "green", "blue"};

struct Property {
  std::string type, name;
};

struct Header {
  std::string format;
  uint64_t vertices = 0;
  std::vector<Property> properties;
  size_t end = 0;  ///< where the data begin
};

template <typename Value>
double number_at(const char* at, bool swapped) {
  std::array<char, sizeof(Value)> raw;
  std::memcpy(raw.data(), at, raw.size());
  if (swapped) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<Value>(raw));
}

size_t bytes_of(const std::string& type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "int" || type == "uint" || type == "int32" || type == "uint32") return 4;
  if (type == "float" || type == "float32") return 4;
  return type == "double" || type == "float64" ? 8 : 0;
}

double read_number(const std::string& type, const char* at, bool swapped) {
  if (type == "char" || type == "int8") return number_at<int8_t>(at, swapped);
  if (type == "uchar" || type == "uint8") return number_at<uint8_t>(at, swapped);
  if (type == "short" || type == "int16") return number_at<int16_t>(at, swapped);
  if (type == "ushort" || type == "uint16") return number_at<uint16_t>(at, swapped);
  if (type == "int" || type == "int32") return number_at<int32_t>(at, swapped);
  if (type == "uint" || type == "uint32") return number_at<uint32_t>(at, swapped);
  if (type == "float" || type == "float32") return number_at<float>(at, swapped);
  return number_at<double>(at, swapped);
}

/// The vertices are described before anything else, and have numbers alone.
absl::Status take_line(const std::string& line, int* elements, Header* header) {
  std::istringstream words(line);
  std::string keyword, first, second;
  words >> keyword >> first >> second;
  if (keyword == "format") header->format = first;
  if (keyword == "element" && ++*elements == 1) {
    if (first != "vertex" || !absl::SimpleAtoi(second, &header->vertices))
      return absl::InvalidArgumentError("has vertices that are not its first element");
  }
  if (keyword == "property" && *elements == 1) {
    if (bytes_of(first) == 0 || header->properties.size() == kMaxProperties)
      return absl::InvalidArgumentError(absl::StrCat("has a property of vertices of the type '", first, "'"));
    header->properties.push_back({first, second});
  }
  return absl::OkStatus();
}

absl::StatusOr<Header> read_header(const std::string& bytes) {
  Header header;
  int elements = 0;
  for (size_t at = 0; at < bytes.size();) {
    const size_t end = std::min(bytes.find('\n', at), bytes.size());
    std::string line = bytes.substr(at, end - at);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (at == 0 && line != "ply") break;
    at = end + 1;
    if (line == "end_header") {
      header.end = std::min(at, bytes.size());
      return header;
    }
    if (auto status = take_line(line, &elements, &header); !status.ok()) return status;
  }
  return absl::InvalidArgumentError("is no PLY with a whole header");
}

/// The places of x, y, z, red, green and blue among the properties.
absl::StatusOr<std::array<size_t, 6>> find_columns(const Header& header) {
  std::array<size_t, 6> columns{};
  for (size_t k = 0; k < columns.size(); ++k) {
    const auto found = std::find_if(header.properties.begin(), header.properties.end(),
                                    [k](const Property& each) { return each.name == kWanted[k]; });
    if (found == header.properties.end())
      return absl::InvalidArgumentError("has no red, green and blue of its vertices");
    columns[k] = static_cast<size_t>(found - header.properties.begin());
  }
  return columns;
}

absl::StatusOr<std::vector<PlyVertex>> read_text(const Header& header, const std::array<size_t, 6>& columns,
                                                 const std::string& bytes) {
  std::istringstream stream(bytes.substr(header.end));
  std::vector<PlyVertex> vertices;
  std::vector<double> row(header.properties.size());
  for (uint64_t n = 0; n < header.vertices; ++n) {
    for (double& value : row) {
      if (!(stream >> value)) return absl::InvalidArgumentError(absl::StrCat("is cut short after ", n, " vertices"));
    }
    PlyVertex& vertex = vertices.emplace_back();
    for (size_t k = 0; k < columns.size(); ++k) vertex[k] = row[columns[k]];
  }
  return vertices;
}

absl::StatusOr<std::vector<PlyVertex>> read_binary(const Header& header, const std::array<size_t, 6>& columns,
                                                   const std::string& bytes) {
  std::vector<size_t> offsets;
  size_t stride = 0;
  for (const Property& property : header.properties) {
    offsets.push_back(stride);
    stride += bytes_of(property.type);
  }
  if (header.vertices > (bytes.size() - header.end) / stride)
    return absl::InvalidArgumentError(absl::StrCat("is cut short: it says that it has ", header.vertices, " vertices"));
  const bool swapped = header.format == "binary_big_endian";
  std::vector<PlyVertex> vertices(header.vertices);
  for (size_t n = 0; n < vertices.size(); ++n) {
    const char* const row = bytes.data() + header.end + n * stride;
    for (size_t k = 0; k < columns.size(); ++k)
      vertices[n][k] = read_number(header.properties[columns[k]].type, row + offsets[columns[k]], swapped);
  }
  return vertices;
}

}  // namespace

absl::StatusOr<std::vector<PlyVertex>> read_ply_colours(const std::string& bytes) {
  const auto header = read_header(bytes);
  if (!header.ok()) return header.status();
  const auto columns = find_columns(*header);
  if (!columns.ok()) return columns.status();
  auto vertices =
      header->format == "ascii" ? read_text(*header, *columns, bytes) : read_binary(*header, *columns, bytes);
  if (!vertices.ok()) return vertices.status();
  for (const PlyVertex& vertex : *vertices) {
    if (!std::all_of(vertex.begin(), vertex.end(), [](double value) { return std::isfinite(value); }))
      return absl::InvalidArgumentError("has a vertex that is not finite");
  }
  return vertices;
}

}  // namespace lipofill::client
