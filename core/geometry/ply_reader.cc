// PLY: text, binary little-endian and binary big-endian. Elements other than vertex and face are
// passed over.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/geometry/ply_header.h"
#include "core/geometry/surface_builder.h"
#include "core/geometry/text_scanner.h"

namespace lipofill::geometry {
namespace {

/// The values of a PLY body, one after the other, whatever their encoding.
class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header)
      : bytes_(bytes), encoding_(header.encoding), offset_(header.body_offset), line_(header.body_line) {}

  /// Reads the next number; none at the end of the file, and for text that is no finite number.
  std::optional<double> next(PlyType type) {
    return encoding_ == PlyEncoding::kAscii ? next_word() : next_binary(type);
  }

  size_t bytes_left() const { return bytes_.size() - offset_; }

  std::string where() const {
    return encoding_ == PlyEncoding::kAscii ? absl::StrCat("line ", line_ + 1) : absl::StrCat("byte ", offset_);
  }

  std::string explain_failure() const {
    if (encoding_ == PlyEncoding::kAscii && !word_.empty()) {
      return absl::StrCat(where(), ": ", quote(word_), " is not a finite number");
    }
    return absl::StrCat(where(), ": the file ends inside its ");
  }
  bool ended() const { return encoding_ != PlyEncoding::kAscii || word_.empty(); }

 private:
  std::optional<double> next_word() {
    std::string_view rest = bytes_.substr(offset_);
    word_ = take_word(rest);
    const size_t word_start = static_cast<size_t>(word_.data() - bytes_.data());
    if (!word_.empty())
      line_ += static_cast<size_t>(std::count(bytes_.begin() + offset_, bytes_.begin() + word_start, '\n'));
    offset_ = bytes_.size() - rest.size();
    return parse_number(word_);
  }

  template <typename Stored>
  double decode() {
    unsigned char raw[sizeof(Stored)];
    std::memcpy(raw, bytes_.data() + offset_, sizeof raw);
    const bool native_is_little = std::endian::native == std::endian::little;
    if ((encoding_ == PlyEncoding::kLittleEndian) != native_is_little) std::reverse(raw, raw + sizeof raw);
    Stored value;
    std::memcpy(&value, raw, sizeof value);
    offset_ += sizeof raw;
    return static_cast<double>(value);
  }

  std::optional<double> next_binary(PlyType type) {
    if (bytes_left() < size_of(type)) return std::nullopt;
    switch (type) {
      case PlyType::kInt8:
        return decode<int8_t>();
      case PlyType::kUint8:
        return decode<uint8_t>();
      case PlyType::kInt16:
        return decode<int16_t>();
      case PlyType::kUint16:
        return decode<uint16_t>();
      case PlyType::kInt32:
        return decode<int32_t>();
      case PlyType::kUint32:
        return decode<uint32_t>();
      case PlyType::kFloat32:
        return decode<float>();
      case PlyType::kFloat64:
        return decode<double>();
    }
    return std::nullopt;
  }

  std::string_view bytes_;
  PlyEncoding encoding_;
  size_t offset_;
  size_t line_;
  std::string_view word_;
};

absl::Status failure(const PlyBody& body, const PlyElement& element) {
  std::string message = body.explain_failure();
  if (body.ended()) absl::StrAppend(&message, quote(element.name), " elements (", element.count, " promised)");
  return absl::InvalidArgumentError(message);
}

/// Reads one record: `scalars` takes the value of each scalar property, `list` the items of the
/// list property `list_index`.
absl::Status read_record(PlyBody& body, const PlyElement& element, int list_index, std::vector<double>& scalars,
                         std::vector<double>& list) {
  for (size_t k = 0; k < element.properties.size(); ++k) {
    const PlyProperty& property = element.properties[k];
    if (!property.is_list) {
      const auto value = body.next(property.type);
      if (!value) return failure(body, element);
      scalars[k] = *value;
      continue;
    }
    const auto count = body.next(property.count_type);
    if (!count) return failure(body, element);
    if (*count < 0 || *count != std::floor(*count) || *count > static_cast<double>(body.bytes_left())) {
      return absl::InvalidArgumentError(absl::StrCat(body.where(), ": a list of ", *count, " items in element ",
                                                     quote(element.name), ", must be in [0, ", body.bytes_left(),
                                                     "], the bytes left"));
    }
    if (static_cast<int>(k) == list_index) list.clear();
    for (double item = 0; item < *count; ++item) {
      const auto value = body.next(property.type);
      if (!value) return failure(body, element);
      if (static_cast<int>(k) == list_index) list.push_back(*value);
    }
  }
  return absl::OkStatus();
}

int find_property(const PlyElement& element, std::string_view name, bool is_list) {
  for (size_t k = 0; k < element.properties.size(); ++k) {
    if (element.properties[k].name == name && element.properties[k].is_list == is_list) return static_cast<int>(k);
  }
  return -1;
}

absl::Status read_vertices(PlyBody& body, const PlyElement& element, SurfaceBuilder& builder) {
  const std::array<int, 3> xyz = {find_property(element, "x", false), find_property(element, "y", false),
                                  find_property(element, "z", false)};
  if (*std::min_element(xyz.begin(), xyz.end()) < 0) {
    return absl::InvalidArgumentError("the PLY header gives element 'vertex' no properties x, y and z");
  }
  std::vector<double> scalars(element.properties.size());
  std::vector<double> unused;
  for (unsigned long long n = 0; n < element.count; ++n) {
    const absl::Status read = read_record(body, element, -1, scalars, unused);
    if (!read.ok()) return read;
    const absl::Status added = builder.add_vertex({scalars[xyz[0]], scalars[xyz[1]], scalars[xyz[2]]},
                                                  absl::StrCat("vertex ", n, " (", body.where(), ")"));
    if (!added.ok()) return added;
  }
  return absl::OkStatus();
}

absl::Status read_faces(PlyBody& body, const PlyElement& element, SurfaceBuilder& builder) {
  int list_index = find_property(element, "vertex_indices", true);
  if (list_index < 0) list_index = find_property(element, "vertex_index", true);
  if (list_index < 0) {
    return absl::InvalidArgumentError("the PLY header gives element 'face' no list vertex_indices or vertex_index");
  }
  std::vector<double> scalars(element.properties.size());
  std::vector<double> list;
  std::vector<long long> corners;
  for (unsigned long long n = 0; n < element.count; ++n) {
    const absl::Status read = read_record(body, element, list_index, scalars, list);
    if (!read.ok()) return read;
    const std::string where = absl::StrCat("face ", n, " (", body.where(), ")");
    corners.clear();
    for (const double item : list) {
      if (!(std::abs(item) < 1e15) || item != std::floor(item)) {
        return absl::InvalidArgumentError(absl::StrCat(where, ": vertex index ", item, " is not a whole number"));
      }
      corners.push_back(static_cast<long long>(item));
    }
    const absl::Status added = builder.add_polygon(corners, where);
    if (!added.ok()) return added;
  }
  return absl::OkStatus();
}

absl::Status pass_over(PlyBody& body, const PlyElement& element) {
  std::vector<double> scalars(element.properties.size());
  std::vector<double> unused;
  for (unsigned long long n = 0; n < element.count; ++n) {
    const absl::Status read = read_record(body, element, -1, scalars, unused);
    if (!read.ok()) return read;
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SurfaceMesh> parse_ply(std::string_view bytes, const SurfaceLimits& limits) {
  const auto header = parse_ply_header(bytes);
  if (!header.ok()) return header.status();
  SurfaceBuilder builder(limits);
  PlyBody body(bytes, *header);
  for (const PlyElement& element : header->elements) {
    const absl::Status status = element.name == "vertex" ? read_vertices(body, element, builder)
                                : element.name == "face" ? read_faces(body, element, builder)
                                                         : pass_over(body, element);
    if (!status.ok()) return status;
  }
  return std::move(builder).build();
}

}  // namespace lipofill::geometry
