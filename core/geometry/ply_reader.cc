// PLY: text, binary little-endian and binary big-endian. Elements other than vertex, face and
// tristrips are passed over, with a remark.

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

  /// Reads the next number, which need not be finite; none at the end of the file, and for text
  /// that is no number.
  std::optional<double> next(PlyType type) {
    return encoding_ == PlyEncoding::kAscii ? next_word() : next_binary(type);
  }

  size_t bytes_left() const { return bytes_.size() - offset_; }

  std::string where() const {
    return encoding_ == PlyEncoding::kAscii ? absl::StrCat("line ", line_ + 1) : absl::StrCat("byte ", offset_);
  }

  std::string explain_failure() const {
    if (encoding_ == PlyEncoding::kAscii && !word_.empty()) {
      return absl::StrCat(where(), ": ", quote(word_), " is not a number");
    }
    return absl::StrCat(where(), ": the file ends inside its ");
  }
  bool ended() const { return encoding_ != PlyEncoding::kAscii || word_.empty(); }

  /// Bytes that stand behind what was read; blanks at the end of a text do not count.
  size_t bytes_behind() const {
    std::string_view rest = bytes_.substr(offset_);
    if (encoding_ == PlyEncoding::kAscii && take_word(rest).empty()) return 0;
    return bytes_left();
  }

 private:
  std::optional<double> next_word() {
    std::string_view rest = bytes_.substr(offset_);
    word_ = take_word(rest);
    const size_t word_start = static_cast<size_t>(word_.data() - bytes_.data());
    if (!word_.empty()) line_ += count_line_ends(bytes_.substr(offset_, word_start - offset_));
    offset_ = bytes_.size() - rest.size();
    return parse_number_or_nan(word_);
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
      case PlyType::kInt64:
        return decode<int64_t>();
      case PlyType::kUint64:
        return decode<uint64_t>();
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

/// The properties that are a vertex's red, green and blue; none where one of them is not there.
std::optional<std::array<int, 3>> find_colour(const PlyElement& element) {
  constexpr std::array<std::array<const char*, 3>, 3> kNames = {
      {{"red", "green", "blue"}, {"diffuse_red", "diffuse_green", "diffuse_blue"}, {"r", "g", "b"}}};
  for (const auto& names : kNames) {
    std::array<int, 3> found{};
    for (size_t c = 0; c < 3; ++c) found[c] = find_property(element, names[c], false);
    if (*std::min_element(found.begin(), found.end()) >= 0) return found;
  }
  return std::nullopt;
}

/// The brightest number of a colour of a type; 0 where the type does not say.
double brightest_of(PlyType type) {
  if (type == PlyType::kUint8) return UINT8_MAX;
  if (type == PlyType::kUint16) return UINT16_MAX;
  return 0.0;
}

absl::Status read_vertices(PlyBody& body, const PlyElement& element, SurfaceBuilder& builder) {
  const std::array<int, 3> xyz = {find_property(element, "x", false), find_property(element, "y", false),
                                  find_property(element, "z", false)};
  if (*std::min_element(xyz.begin(), xyz.end()) < 0) {
    return absl::InvalidArgumentError("the PLY header gives element 'vertex' no properties x, y and z");
  }
  const auto rgb = find_colour(element);
  if (rgb) builder.set_brightest(brightest_of(element.properties[static_cast<size_t>((*rgb)[0])].type));
  std::vector<double> scalars(element.properties.size());
  std::vector<double> unused;
  for (unsigned long long n = 0; n < element.count; ++n) {
    const absl::Status read = read_record(body, element, -1, scalars, unused);
    if (!read.ok()) return read;
    const absl::Status added = builder.add_vertex({scalars[xyz[0]], scalars[xyz[1]], scalars[xyz[2]]},
                                                  absl::StrCat("vertex ", n, " (", body.where(), ")"));
    if (!added.ok()) return added;
    if (rgb) builder.add_colour({scalars[(*rgb)[0]], scalars[(*rgb)[1]], scalars[(*rgb)[2]]});
  }
  return absl::OkStatus();
}

/// The list of vertex indices of an element.
absl::StatusOr<int> find_indices(const PlyElement& element) {
  for (const char* name : {"vertex_indices", "vertex_index"}) {
    if (const int index = find_property(element, name, true); index >= 0) return index;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("the PLY header gives element ", quote(element.name), " no list vertex_indices or vertex_index"));
}

absl::StatusOr<long long> to_index(double item, const std::string& where) {
  if (std::abs(item) < 1e15 && item == std::floor(item)) return static_cast<long long>(item);
  return absl::InvalidArgumentError(absl::StrCat(where, ": vertex index ", item, " is not a whole number"));
}

/// Calls add(indices, where) for the list of vertex indices in each record of an element.
template <typename Add>
absl::Status read_lists(PlyBody& body, const PlyElement& element, const Add& add) {
  const auto list_index = find_indices(element);
  if (!list_index.ok()) return list_index.status();
  std::vector<double> scalars(element.properties.size());
  std::vector<double> list;
  for (unsigned long long n = 0; n < element.count; ++n) {
    const absl::Status read = read_record(body, element, *list_index, scalars, list);
    if (!read.ok()) return read;
    const absl::Status added = add(list, absl::StrCat(element.name, " ", n, " (", body.where(), ")"));
    if (!added.ok()) return added;
  }
  return absl::OkStatus();
}

absl::Status read_faces(PlyBody& body, const PlyElement& element, SurfaceBuilder& builder) {
  std::vector<long long> corners;
  return read_lists(body, element, [&](const std::vector<double>& list, const std::string& where) -> absl::Status {
    corners.clear();
    for (const double item : list) {
      const auto corner = to_index(item, where);
      if (!corner.ok()) return corner.status();
      corners.push_back(*corner);
    }
    return builder.add_polygon(corners, where);
  });
}

/// True for what ends a strip: -1, or what -1 becomes in a type without a sign.
bool ends_strip(double item, PlyType type) {
  if (type == PlyType::kUint32) return item == static_cast<double>(UINT32_MAX);
  if (type == PlyType::kUint64) return item == static_cast<double>(UINT64_MAX);
  return item < 0.0;
}

/// Strips of triangles: each index makes one with the two before it, every other one turned over. A
/// triangle of which two corners are one only leads the strip on.
absl::Status read_strips(PlyBody& body, const PlyElement& element, SurfaceBuilder& builder) {
  const auto list_index = find_indices(element);
  if (!list_index.ok()) return list_index.status();
  const PlyType type = element.properties[static_cast<size_t>(*list_index)].type;
  std::vector<long long> strip;
  return read_lists(body, element, [&](const std::vector<double>& list, const std::string& where) -> absl::Status {
    strip.clear();
    for (const double item : list) {
      if (ends_strip(item, type)) {
        strip.clear();
        continue;
      }
      const auto corner = to_index(item, where);
      if (!corner.ok()) return corner.status();
      strip.push_back(*corner);
      const size_t n = strip.size();
      if (n < 3) continue;
      const long long a = strip[n - 3], b = strip[n - 2], c = strip[n - 1];
      if (a == b || b == c || c == a) continue;
      const bool is_turned = n % 2 == 0;
      const absl::Status added = builder.add_polygon({is_turned ? b : a, is_turned ? a : b, c}, where);
      if (!added.ok()) return added;
    }
    return absl::OkStatus();
  });
}

absl::Status pass_over(PlyBody& body, const PlyElement& element, SurfaceBuilder& builder) {
  std::vector<double> scalars(element.properties.size());
  std::vector<double> unused;
  for (unsigned long long n = 0; n < element.count; ++n) {
    const absl::Status read = read_record(body, element, -1, scalars, unused);
    if (!read.ok()) return read;
  }
  if (element.count > 0) {
    builder.add_remark(
        absl::StrCat(element.count, " of element ", quote(element.name), " passed over: they shape no surface."));
  }
  return absl::OkStatus();
}

absl::Status read_element(PlyBody& body, const PlyElement& element, SurfaceBuilder& builder) {
  if (element.name == "vertex") return read_vertices(body, element, builder);
  if (element.name == "face") return read_faces(body, element, builder);
  if (element.name == "tristrips") return read_strips(body, element, builder);
  return pass_over(body, element, builder);
}

}  // namespace

absl::StatusOr<ScannedSurface> parse_ply(std::string_view bytes, const SurfaceLimits& limits) {
  bytes = skip_byte_order_mark(bytes);
  const auto header = parse_ply_header(bytes);
  if (!header.ok()) return header.status();
  SurfaceBuilder builder(limits);
  if (header->unknown_lines > 0) {
    builder.add_remark(absl::StrCat(count_of(header->unknown_lines, "line", "lines"),
                                    " of the PLY header not known and passed over."));
  }
  PlyBody body(bytes, *header);
  for (const PlyElement& element : header->elements) {
    const absl::Status status = read_element(body, element, builder);
    if (!status.ok()) return status;
  }
  if (const size_t behind = body.bytes_behind(); behind > 0) {
    builder.add_remark(absl::StrCat(count_of(behind, "byte", "bytes"), " behind the last element passed over."));
  }
  return std::move(builder).build();
}

}  // namespace lipofill::geometry
