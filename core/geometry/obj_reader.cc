// Wavefront OBJ: the statements that shape a surface (v, f) are parsed here to the last byte, the
// others are known and passed over.

#include <algorithm>
#include <array>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "core/geometry/surface_builder.h"
#include "core/geometry/text_scanner.h"

namespace lipofill::geometry {
namespace {

constexpr std::array<std::string_view, 22> kPassedOver = {
    "vt",     "vn",     "vp",    "g",        "o",        "s",   "l",          "p",         "mg", "mtllib", "usemtl",
    "maplib", "usemap", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj", "vw", "param",  "deg"};

std::string at_line(size_t line_number) {
  return absl::StrCat("line ", line_number);
}

absl::Status parse_vertex(std::string_view line, size_t line_number, SurfaceBuilder& builder) {
  std::array<double, 3> xyz{};
  for (double& x : xyz) {
    const std::string_view word = take_word(line);
    const auto value = parse_number(word);
    if (!value) {
      return absl::InvalidArgumentError(
          absl::StrCat(at_line(line_number), ": vertex coordinate ", quote(word), " is not a finite number"));
    }
    x = *value;
  }
  return builder.add_vertex(xyz, at_line(line_number));
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

absl::Status parse_face(std::string_view line, size_t line_number, std::vector<long long>& corners,
                        SurfaceBuilder& builder) {
  corners.clear();
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
    const auto corner = parse_corner(word, line_number, builder.n_vertices());
    if (!corner.ok()) return corner.status();
    corners.push_back(*corner);
  }
  return builder.add_polygon(corners, at_line(line_number));
}

}  // namespace

absl::StatusOr<SurfaceMesh> parse_obj(std::string_view bytes, const SurfaceLimits& limits) {
  SurfaceBuilder builder(limits);
  LineScanner lines(bytes);
  std::vector<long long> corners;
  for (std::string_view line; lines.next(line);) {
    const std::string_view keyword = take_word(line);
    if (keyword.empty() || keyword.front() == '#') continue;
    absl::Status status;
    if (keyword == "v") {
      status = parse_vertex(line, lines.line_number(), builder);
    } else if (keyword == "f") {
      status = parse_face(line, lines.line_number(), corners, builder);
    } else if (std::find(kPassedOver.begin(), kPassedOver.end(), keyword) == kPassedOver.end()) {
      status = absl::InvalidArgumentError(
          absl::StrCat(at_line(lines.line_number()), ": ", quote(keyword), " is no statement of an OBJ surface"));
    }
    if (!status.ok()) return status;
  }
  return std::move(builder).build();
}

}  // namespace lipofill::geometry
