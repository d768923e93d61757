// STL, binary and text, with one solid or several, which become one surface. The format repeats a
// vertex for every triangle; equal points become one vertex, in the order they first appear.

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <unordered_map>

#include "absl/strings/str_cat.h"
#include "core/geometry/surface_builder.h"
#include "core/geometry/text_scanner.h"

namespace lipofill::geometry {
namespace {

constexpr size_t kBinaryHeader = 84;
constexpr size_t kBinaryTriangle = 50;

struct PointHash {
  size_t operator()(const std::array<double, 3>& p) const {
    uint64_t hash = 1469598103934665603ull;
    for (const double x : p) hash = (hash ^ std::bit_cast<uint64_t>(x)) * 1099511628211ull + (hash >> 29);
    return static_cast<size_t>(hash);
  }
};

/// Vertices by position. Only looked up, never walked: the order of the hash table reaches nothing.
class PointMerger {
 public:
  explicit PointMerger(SurfaceBuilder& builder) : builder_(builder) {}

  absl::StatusOr<long long> vertex_at(std::array<double, 3> p, const std::string& where) {
    for (double& x : p) x += 0.0;  // -0 and 0 are one place
    const auto [entry, is_new] = vertices_.try_emplace(p, builder_.n_vertices());
    if (is_new) {
      const absl::Status added = builder_.add_vertex(p, where);
      if (!added.ok()) return added;
    }
    return entry->second;
  }

 private:
  SurfaceBuilder& builder_;
  std::unordered_map<std::array<double, 3>, long long, PointHash> vertices_;
};

double read_float_le(const char* bytes) {
  unsigned char raw[4];
  std::memcpy(raw, bytes, sizeof raw);
  const uint32_t bits = raw[0] | raw[1] << 8 | raw[2] << 16 | static_cast<uint32_t>(raw[3]) << 24;
  return std::bit_cast<float>(bits);
}

unsigned long long binary_triangle_count(std::string_view bytes) {
  unsigned long long count = 0;
  for (size_t k = 0; k < 4; ++k)
    count |= static_cast<unsigned long long>(static_cast<unsigned char>(bytes[80 + k])) << (8 * k);
  return count;
}

/// Triangles in the file: as many as it promises, or as it has where it promises none, as programs
/// do that write before they know.
unsigned long long count_triangles(std::string_view bytes, SurfaceBuilder& builder) {
  const unsigned long long promised = binary_triangle_count(bytes);
  const unsigned long long room = (bytes.size() - kBinaryHeader) / kBinaryTriangle;
  const unsigned long long count = promised == 0 ? room : promised;
  if (promised == 0 && count > 0) {
    builder.add_remark(
        absl::StrCat("The STL file promises no triangle but has room for ", count, ", which were read."));
  }
  const size_t behind = bytes.size() - kBinaryHeader - kBinaryTriangle * count;
  if (behind > 0) {
    builder.add_remark(absl::StrCat(count_of(behind, "byte", "bytes"), " behind the last triangle passed over."));
  }
  return count;
}

absl::StatusOr<ScannedSurface> parse_binary(std::string_view bytes, const SurfaceLimits& limits) {
  SurfaceBuilder builder(limits);
  PointMerger merger(builder);
  std::vector<long long> corners(3);
  const unsigned long long count = count_triangles(bytes, builder);
  for (unsigned long long t = 0; t < count; ++t) {
    const size_t offset = kBinaryHeader + kBinaryTriangle * t;
    const std::string where = absl::StrCat("byte ", offset);
    for (size_t c = 0; c < 3; ++c) {
      const char* p = bytes.data() + offset + 12 + 12 * c;  // the facet's normal comes first
      const auto vertex = merger.vertex_at({read_float_le(p), read_float_le(p + 4), read_float_le(p + 8)}, where);
      if (!vertex.ok()) return vertex.status();
      corners[c] = *vertex;
    }
    const absl::Status added = builder.add_polygon(corners, where);
    if (!added.ok()) return added;
  }
  return std::move(builder).build();
}

bool is_word(std::string_view word, std::string_view expected) {
  return word.size() == expected.size() && begins_with_ignoring_case(word, expected);
}

/// Reads solids of "facet normal ... outer loop, vertices, endloop, endfacet", word by word, in
/// whatever case.
class StlText {
 public:
  StlText(std::string_view bytes, const SurfaceLimits& limits) : lines_(bytes), builder_(limits), merger_(builder_) {}

  absl::StatusOr<ScannedSurface> parse() &&;

 private:
  absl::Status read_solid();
  absl::Status read_facet();
  absl::StatusOr<long long> read_vertex();
  absl::Status expect(std::string_view expected);

  /// Next word, walking over ends of line; empty at the end of the file.
  std::string_view next() {
    std::string_view word = take_word(line_);
    while (word.empty() && lines_.next(line_)) word = take_word(line_);
    return word;
  }
  void skip_line() { line_ = {}; }
  std::string where() const { return absl::StrCat("line ", lines_.line_number()); }

  absl::Status not_due(std::string_view word, std::string_view due) const {
    if (word.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(where(), ": the file ends where ", std::string(due), " is due"));
    }
    return absl::InvalidArgumentError(
        absl::StrCat(where(), ": ", quote(word), " where ", std::string(due), " is due in an STL text"));
  }

  LineScanner lines_;
  std::string_view line_;
  SurfaceBuilder builder_;
  PointMerger merger_;
  std::vector<long long> corners_;
};

absl::Status StlText::expect(std::string_view expected) {
  const std::string_view word = next();
  if (is_word(word, expected)) return absl::OkStatus();
  return not_due(word, quote(expected));
}

absl::StatusOr<long long> StlText::read_vertex() {
  std::array<double, 3> xyz{};
  for (double& x : xyz) {
    const std::string_view word = next();
    const auto value = parse_number(word);
    if (!value) {
      return absl::InvalidArgumentError(
          absl::StrCat(where(), ": vertex coordinate ", quote(word), " is not a finite number"));
    }
    x = *value;
  }
  return merger_.vertex_at(xyz, where());
}

/// Reads what follows the word "facet". The normal counts for nothing: the corners give it.
absl::Status StlText::read_facet() {
  std::string_view word = next();
  while (!word.empty() && !is_word(word, "outer") && !is_word(word, "endfacet")) word = next();
  if (!is_word(word, "outer")) return not_due(word, "'outer'");
  if (absl::Status status = expect("loop"); !status.ok()) return status;
  corners_.clear();
  for (word = next(); !is_word(word, "endloop"); word = next()) {
    if (!is_word(word, "vertex")) return not_due(word, "'vertex'");
    const auto vertex = read_vertex();
    if (!vertex.ok()) return vertex.status();
    corners_.push_back(*vertex);
  }
  if (absl::Status status = expect("endfacet"); !status.ok()) return status;
  return builder_.add_polygon(corners_, where());
}

/// Reads what follows the word "solid" and its name.
absl::Status StlText::read_solid() {
  for (;;) {
    const std::string_view word = next();
    if (is_word(word, "endsolid")) return absl::OkStatus();
    if (word.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(where(), ": the STL text ends without 'endsolid'"));
    }
    if (!is_word(word, "facet")) return not_due(word, "'facet' or 'endsolid'");
    if (absl::Status status = read_facet(); !status.ok()) return status;
  }
}

absl::StatusOr<ScannedSurface> StlText::parse() && {
  size_t solids = 0;
  size_t passed_over = 0;
  for (std::string_view word = next(); !word.empty(); word = next()) {
    const bool is_solid = is_word(word, "solid");
    skip_line();  // the name of the solid
    if (!is_solid) {
      ++passed_over;
      continue;
    }
    if (const absl::Status status = read_solid(); !status.ok()) return status;
    skip_line();  // its name again
    ++solids;
  }
  if (solids > 1) builder_.add_remark(absl::StrCat(solids, " solids read as one surface."));
  if (passed_over > 0) {
    builder_.add_remark(absl::StrCat(count_of(passed_over, "line", "lines"), " outside the solids passed over."));
  }
  return std::move(builder_).build();
}

/// A text begins with "solid" and has no byte 0, which the header, count and first triangle of a
/// binary file all but always have.
bool looks_like_text(std::string_view bytes) {
  constexpr size_t kLookedAt = 1024;
  std::string_view rest = skip_byte_order_mark(bytes);
  const std::string_view word = [&rest] {
    LineScanner lines(rest);
    std::string_view line;
    std::string_view first;
    while (first.empty() && lines.next(line)) first = take_word(line);
    return first;
  }();
  return is_word(word, "solid") && bytes.substr(0, kLookedAt).find('\0') == std::string_view::npos;
}

}  // namespace

absl::StatusOr<ScannedSurface> parse_stl(std::string_view bytes, const SurfaceLimits& limits) {
  const unsigned long long count = bytes.size() < kBinaryHeader ? 0 : binary_triangle_count(bytes);
  const unsigned long long promised = kBinaryHeader + kBinaryTriangle * count;
  // Some binary files begin with "solid" too; their length gives them away.
  if (bytes.size() == promised) return parse_binary(bytes, limits);
  if (looks_like_text(bytes)) return StlText(skip_byte_order_mark(bytes), limits).parse();
  if (bytes.size() < kBinaryHeader) {
    return absl::InvalidArgumentError(absl::StrCat("the file has ", bytes.size(),
                                                   " bytes and does not start with 'solid', so it is not an STL file"));
  }
  if (bytes.size() > promised) return parse_binary(bytes, limits);
  return absl::InvalidArgumentError(absl::StrCat("the STL file promises ", count, " triangles, that is ", promised,
                                                 " bytes, but has ", bytes.size(), " bytes"));
}

}  // namespace lipofill::geometry
