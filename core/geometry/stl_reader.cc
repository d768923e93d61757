// STL, binary and text. The format repeats a vertex for every triangle; equal points become one
// vertex, in the order they first appear.

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

absl::StatusOr<SurfaceMesh> parse_binary(std::string_view bytes, const SurfaceLimits& limits) {
  SurfaceBuilder builder(limits);
  PointMerger merger(builder);
  std::vector<long long> corners(3);
  for (size_t offset = kBinaryHeader; offset + kBinaryTriangle <= bytes.size(); offset += kBinaryTriangle) {
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

/// Reads "facet normal ... outer loop, three vertices, endloop, endfacet", word by word.
class StlText {
 public:
  explicit StlText(std::string_view bytes) : lines_(bytes) {}

  /// Next word, walking over ends of line; empty at the end of the file.
  std::string_view next() {
    std::string_view word = take_word(line_);
    while (word.empty() && lines_.next(line_)) word = take_word(line_);
    return word;
  }
  void skip_line() { line_ = {}; }
  std::string where() const { return absl::StrCat("line ", lines_.line_number()); }

  absl::Status expect(std::string_view expected) {
    const std::string_view word = next();
    if (word == expected) return absl::OkStatus();
    if (word.empty()) {
      return absl::InvalidArgumentError(
          absl::StrCat(where(), ": the file ends where '", std::string(expected), "' is due"));
    }
    return absl::InvalidArgumentError(
        absl::StrCat(where(), ": ", quote(word), " where '", std::string(expected), "' is due in an STL text"));
  }

 private:
  LineScanner lines_;
  std::string_view line_;
};

absl::StatusOr<long long> read_text_vertex(StlText& text, PointMerger& merger) {
  const absl::Status status = text.expect("vertex");
  if (!status.ok()) return status;
  std::array<double, 3> xyz{};
  for (double& x : xyz) {
    const std::string_view word = text.next();
    const auto value = parse_number(word);
    if (!value) {
      return absl::InvalidArgumentError(
          absl::StrCat(text.where(), ": vertex coordinate ", quote(word), " is not a finite number"));
    }
    x = *value;
  }
  return merger.vertex_at(xyz, text.where());
}

absl::Status read_text_facet(StlText& text, PointMerger& merger, SurfaceBuilder& builder) {
  text.skip_line();  // the normal: given by the corners
  for (const char* word : {"outer", "loop"}) {
    const absl::Status status = text.expect(word);
    if (!status.ok()) return status;
  }
  std::vector<long long> corners(3);
  for (long long& corner : corners) {
    const auto vertex = read_text_vertex(text, merger);
    if (!vertex.ok()) return vertex.status();
    corner = *vertex;
  }
  for (const char* word : {"endloop", "endfacet"}) {
    const absl::Status status = text.expect(word);
    if (!status.ok()) return status;
  }
  return builder.add_polygon(corners, text.where());
}

absl::StatusOr<SurfaceMesh> parse_text(std::string_view bytes, const SurfaceLimits& limits) {
  SurfaceBuilder builder(limits);
  PointMerger merger(builder);
  StlText text(bytes);
  text.next();       // "solid"
  text.skip_line();  // and its name
  for (;;) {
    const std::string_view word = text.next();
    if (word == "endsolid") return std::move(builder).build();
    if (word == "facet") {
      const absl::Status status = read_text_facet(text, merger, builder);
      if (!status.ok()) return status;
    } else if (word.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(text.where(), ": the STL text ends without 'endsolid'"));
    } else {
      return absl::InvalidArgumentError(
          absl::StrCat(text.where(), ": ", quote(word), " where 'facet' or 'endsolid' is due in an STL text"));
    }
  }
}

}  // namespace

absl::StatusOr<SurfaceMesh> parse_stl(std::string_view bytes, const SurfaceLimits& limits) {
  if (bytes.size() >= kBinaryHeader) {
    const unsigned long long promised = kBinaryHeader + kBinaryTriangle * binary_triangle_count(bytes);
    // Some binary files begin with "solid" too; their length gives them away.
    if (bytes.size() == promised) return parse_binary(bytes, limits);
    if (bytes.substr(0, 5) != "solid") {
      return absl::InvalidArgumentError(absl::StrCat("the STL file promises ", binary_triangle_count(bytes),
                                                     " triangles, that is ", promised, " bytes, but has ", bytes.size(),
                                                     " bytes"));
    }
  }
  if (bytes.substr(0, 5) != "solid") {
    return absl::InvalidArgumentError(absl::StrCat("the file has ", bytes.size(),
                                                   " bytes and does not start with 'solid', so it is not an STL file"));
  }
  return parse_text(bytes, limits);
}

}  // namespace lipofill::geometry
