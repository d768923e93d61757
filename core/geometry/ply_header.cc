#include "core/geometry/ply_header.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/geometry/text_scanner.h"

namespace lipofill::geometry {
namespace {

constexpr size_t kMaxElements = 64;
constexpr size_t kMaxProperties = 256;

absl::Status error_at(size_t line, std::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("line ", line, " of the PLY header: ", std::string(what)));
}

std::optional<PlyType> parse_type(std::string_view word) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 18> kTypes = {{{"char", PlyType::kInt8},
                                                                            {"int8", PlyType::kInt8},
                                                                            {"uchar", PlyType::kUint8},
                                                                            {"uint8", PlyType::kUint8},
                                                                            {"short", PlyType::kInt16},
                                                                            {"int16", PlyType::kInt16},
                                                                            {"ushort", PlyType::kUint16},
                                                                            {"uint16", PlyType::kUint16},
                                                                            {"int", PlyType::kInt32},
                                                                            {"int32", PlyType::kInt32},
                                                                            {"uint", PlyType::kUint32},
                                                                            {"uint32", PlyType::kUint32},
                                                                            {"int64", PlyType::kInt64},
                                                                            {"uint64", PlyType::kUint64},
                                                                            {"float", PlyType::kFloat32},
                                                                            {"float32", PlyType::kFloat32},
                                                                            {"double", PlyType::kFloat64},
                                                                            {"float64", PlyType::kFloat64}}};
  for (const auto& [name, type] : kTypes) {
    if (name == word) return type;
  }
  return std::nullopt;
}

absl::Status parse_format(std::string_view rest, size_t line, PlyHeader& header) {
  const std::string_view word = take_word(rest);
  if (word == "ascii") {
    header.encoding = PlyEncoding::kAscii;
  } else if (word == "binary_little_endian") {
    header.encoding = PlyEncoding::kLittleEndian;
  } else if (word == "binary_big_endian") {
    header.encoding = PlyEncoding::kBigEndian;
  } else {
    return error_at(line,
                    absl::StrCat("format ", quote(word), " is not ascii, binary_little_endian or binary_big_endian"));
  }
  const std::string_view version = take_word(rest);
  if (version != "1.0") return error_at(line, absl::StrCat("version ", quote(version), ", must be 1.0"));
  return absl::OkStatus();
}

absl::Status parse_element(std::string_view rest, size_t line, PlyHeader& header) {
  PlyElement element;
  element.name = std::string(take_word(rest));
  const std::string_view word = take_word(rest);
  const auto count = parse_integer(word);
  if (!count || *count < 0) {
    return error_at(line, absl::StrCat("count ", quote(word), " of element ", quote(element.name),
                                       " is not a number of 0 or more"));
  }
  if (header.elements.size() >= kMaxElements) return error_at(line, "more than 64 elements");
  element.count = static_cast<unsigned long long>(*count);
  header.elements.push_back(std::move(element));
  return absl::OkStatus();
}

absl::Status parse_property(std::string_view rest, size_t line, PlyHeader& header) {
  if (header.elements.empty()) return error_at(line, "a property before any element");
  PlyElement& element = header.elements.back();
  if (element.properties.size() >= kMaxProperties) return error_at(line, "more than 256 properties");
  PlyProperty property;
  std::string_view word = take_word(rest);
  if (word == "list") {
    property.is_list = true;
    word = take_word(rest);
    const auto count_type = parse_type(word);
    if (!count_type || *count_type == PlyType::kFloat32 || *count_type == PlyType::kFloat64) {
      return error_at(line, absl::StrCat("list count type ", quote(word), " is not a PLY integer type"));
    }
    property.count_type = *count_type;
    word = take_word(rest);
  }
  const auto type = parse_type(word);
  if (!type) return error_at(line, absl::StrCat("type ", quote(word), " is not a PLY type"));
  property.type = *type;
  property.name = std::string(take_word(rest));
  element.properties.push_back(std::move(property));
  return absl::OkStatus();
}

/// Fewest bytes one record can take: in text a digit and a blank a value.
size_t smallest_record(const PlyElement& element, PlyEncoding encoding) {
  size_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    bytes += encoding == PlyEncoding::kAscii ? 2 : size_of(property.is_list ? property.count_type : property.type);
  }
  return bytes;
}

absl::Status check_counts(const PlyHeader& header, size_t body_bytes) {
  unsigned long long needed = 0;
  for (const PlyElement& element : header.elements) {
    if (element.count == 0) continue;
    if (element.properties.empty()) {
      return absl::InvalidArgumentError(absl::StrCat("PLY element ", quote(element.name), " has no properties"));
    }
    const size_t record = smallest_record(element, header.encoding);
    // A text may end without the last blank.
    if (element.count > (body_bytes + 1) / record || needed + element.count * record > body_bytes + 1) {
      return absl::InvalidArgumentError(absl::StrCat("the PLY header promises ", element.count, " of element ",
                                                     quote(element.name), ", at least ", record, " bytes each; only ",
                                                     body_bytes, " bytes follow the header"));
    }
    needed += element.count * record;
  }
  return absl::OkStatus();
}

absl::Status parse_line(std::string_view line, size_t number, PlyHeader& header, bool& has_format) {
  const std::string_view keyword = take_word(line);
  if (keyword.empty() || keyword == "comment" || keyword == "obj_info") return absl::OkStatus();
  if (keyword == "format") {
    has_format = true;
    return parse_format(line, number, header);
  }
  if (keyword == "element") return parse_element(line, number, header);
  if (keyword == "property") return parse_property(line, number, header);
  ++header.unknown_lines;
  return absl::OkStatus();
}

/// Finds where a line of the text ends.
size_t end_of(std::string_view bytes, std::string_view line) {
  return static_cast<size_t>(line.data() + line.size() - bytes.data());
}

bool ends_with_lone_return(std::string_view bytes, std::string_view line) {
  const std::string_view behind = bytes.substr(end_of(bytes, line));
  return behind.starts_with('\r') && !behind.starts_with("\r\n");
}

}  // namespace

size_t size_of(PlyType type) {
  constexpr std::array<size_t, 10> kSizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<size_t>(type)];
}

absl::StatusOr<PlyHeader> parse_ply_header(std::string_view bytes) {
  PlyHeader header;
  LineScanner lines(bytes);
  std::string_view line;
  if (std::string_view first; !lines.next(line) || (first = line, take_word(first) != "ply")) {
    return absl::InvalidArgumentError("line 1: the file does not start with 'ply', so it is not a PLY file");
  }
  const bool has_lone_returns = ends_with_lone_return(bytes, line);
  bool has_format = false;
  while (lines.next(line)) {
    std::string_view words = line;
    if (take_word(words) == "end_header") {
      if (!has_format) return error_at(lines.line_number(), "the header ends without a format");
      const size_t behind = bytes.size() - lines.rest().size();
      header.body_offset = has_lone_returns ? std::min(end_of(bytes, line) + 1, behind) : behind;
      header.body_line = lines.line_number();
      const absl::Status counts = check_counts(header, bytes.size() - header.body_offset);
      if (!counts.ok()) return counts;
      return header;
    }
    const absl::Status status = parse_line(line, lines.line_number(), header, has_format);
    if (!status.ok()) return status;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("the PLY header has no end_header up to the end of the file, line ", lines.line_number()));
}

}  // namespace lipofill::geometry
