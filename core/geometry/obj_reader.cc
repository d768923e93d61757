// Wavefront OBJ: the statements that shape a surface (v, f) are parsed here to the last byte. Known
// others are passed over, and so are unknown ones, with a remark.

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/geometry/surface_builder.h"
#include "core/geometry/text_scanner.h"

namespace lipofill::geometry {
namespace {

constexpr std::array<std::string_view, 22> kPassedOver = {
    "vt",     "vn",     "vp",    "g",        "o",        "s",   "l",          "p",         "mg", "mtllib", "usemtl",
    "maplib", "usemap", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj", "vw", "param",  "deg"};

/// These have names of files and parts, in which a backslash at the end of the line is part of the
/// name.
constexpr std::array<std::string_view, 10> kNaming = {"g",      "o",          "mtllib",    "usemtl", "maplib",
                                                      "usemap", "shadow_obj", "trace_obj", "call",   "csh"};

bool is_among(const auto& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string at_line(size_t line_number) {
  return absl::StrCat("line ", line_number);
}

/// Statements that this reader does not know, of which some kinds are named.
class UnknownStatements {
 public:
  void add(std::string_view keyword, size_t line_number) {
    if (count_++ == 0) first_ = absl::StrCat(at_line(line_number), ": ", quote(keyword));
    const std::string name = quote(keyword);
    if (names_.size() < kMostNamed && !is_among(names_, name)) names_.push_back(name);
  }

  bool empty() const { return count_ == 0; }
  const std::string& first() const { return first_; }

  std::string describe() const {
    const char* others = names_.size() == kMostNamed ? " and others" : "";
    return absl::StrCat(count_of(count_, "statement that shapes", "statements that shape"),
                        " no polygon passed over: ", absl::StrJoin(names_, ", "), others, ".");
  }

 private:
  static constexpr size_t kMostNamed = 8;
  size_t count_ = 0;
  std::string first_;
  std::vector<std::string> names_;
};

class ObjParser {
 public:
  ObjParser(std::string_view bytes, const SurfaceLimits& limits) : lines_(bytes), builder_(limits) {}

  absl::StatusOr<ScannedSurface> parse() &&;

 private:
  absl::Status parse_statement(std::string_view keyword, std::string_view line, size_t line_number);
  absl::Status parse_vertex(std::string_view line, size_t line_number);
  absl::Status parse_face(std::string_view line, size_t line_number);
  std::string_view join_continued(std::string_view line);

  LineScanner lines_;
  SurfaceBuilder builder_;
  UnknownStatements unknown_;
  std::string joined_;
  std::vector<long long> corners_;
};

/// Takes the backslash off a line that goes on in the next one; false where it does not.
bool take_backslash(std::string_view& line) {
  const size_t last = line.find_last_not_of(" \t");
  if (last == std::string_view::npos || line[last] != '\\') return false;
  line = line.substr(0, last);
  return true;
}

/// A statement with the lines that it goes on in, each but the last ending with a backslash.
std::string_view ObjParser::join_continued(std::string_view line) {
  if (!take_backslash(line)) return line;
  joined_.assign(line);
  for (bool goes_on = true; goes_on && lines_.next(line);) {
    goes_on = take_backslash(line);
    joined_ += ' ';
    joined_ += line;
  }
  return joined_;
}

/// The colour behind a vertex's place: three numbers, or four with how opaque it is. One number
/// alone is a weight.
std::optional<std::array<double, 3>> take_colour(std::string_view line) {
  std::array<double, 3> rgb{};
  for (double& part : rgb) {
    const auto value = parse_number(take_word(line));
    if (!value) return std::nullopt;
    part = *value;
  }
  return rgb;
}

absl::Status ObjParser::parse_vertex(std::string_view line, size_t line_number) {
  std::array<double, 3> xyz{};
  for (double& x : xyz) {
    const std::string_view word = take_word(line);
    const auto value = parse_number_or_nan(word);
    if (!value) {
      return absl::InvalidArgumentError(
          absl::StrCat(at_line(line_number), ": vertex coordinate ", quote(word), " is not a number"));
    }
    x = *value;
  }
  if (const absl::Status added = builder_.add_vertex(xyz, at_line(line_number)); !added.ok()) return added;
  if (const auto rgb = take_colour(line)) builder_.add_colour(*rgb);
  return absl::OkStatus();
}

/// The vertex of a corner "v", "v/vt", "v//vn" or "v/vt/vn", counted from 0. Negative indices count
/// back from the last vertex.
absl::StatusOr<long long> parse_corner(std::string_view word, size_t line_number, long long n_vertices) {
  const auto index = parse_integer(word.substr(0, word.find('/')));
  const long long vertex = !index                                ? -1
                           : *index > 0                          ? *index - 1
                           : *index < 0 && *index >= -n_vertices ? n_vertices + *index
                                                                 : -1;
  if (vertex < 0) {
    return absl::InvalidArgumentError(absl::StrCat(at_line(line_number), ": face corner ", quote(word),
                                                   " does not name a vertex, must be in [1, ", n_vertices,
                                                   "] or count back from -1"));
  }
  return vertex;
}

absl::Status ObjParser::parse_face(std::string_view line, size_t line_number) {
  corners_.clear();
  for (std::string_view word = take_word(line); !word.empty() && word.front() != '#'; word = take_word(line)) {
    const auto corner = parse_corner(word, line_number, builder_.n_vertices());
    if (!corner.ok()) return corner.status();
    corners_.push_back(*corner);
  }
  return builder_.add_polygon(corners_, at_line(line_number));
}

absl::Status ObjParser::parse_statement(std::string_view keyword, std::string_view line, size_t line_number) {
  if (keyword == "v") return parse_vertex(line, line_number);
  if (keyword == "f" || keyword == "fo") return parse_face(line, line_number);
  if (!is_among(kPassedOver, keyword)) unknown_.add(keyword, line_number);
  return absl::OkStatus();
}

absl::StatusOr<ScannedSurface> ObjParser::parse() && {
  for (std::string_view line; lines_.next(line);) {
    const size_t line_number = lines_.line_number();
    std::string_view keyword = take_word(line);
    if (keyword.empty() || keyword.front() == '#') continue;
    if (keyword.size() > 1 && keyword.back() == '\\') {
      line = keyword.substr(keyword.size() - 1);
      keyword.remove_suffix(1);
    }
    if (!is_among(kNaming, keyword)) line = join_continued(line);
    const absl::Status status = parse_statement(keyword, line, line_number);
    if (!status.ok()) return status;
  }
  if (builder_.n_vertices() == 0 && !unknown_.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(unknown_.first(), " is no statement of an OBJ surface, and the file has no vertex"));
  }
  if (!unknown_.empty()) builder_.add_remark(unknown_.describe());
  return std::move(builder_).build();
}

}  // namespace

absl::StatusOr<ScannedSurface> parse_obj(std::string_view bytes, const SurfaceLimits& limits) {
  return ObjParser(skip_byte_order_mark(bytes), limits).parse();
}

}  // namespace lipofill::geometry
