#include "client/cpp/gltf/gltf_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/gltf/gltf_accessor.h"

namespace lipofill::client {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;

constexpr size_t kMaxPoints = 20'000'000;
constexpr size_t kMaxNodes = 100'000;
constexpr int kMaxDepth = 100;
constexpr double kLargestInMetres = 5.0;
constexpr double kMmPerMetre = 1000.0;
constexpr int kTriangles = 4, kStrip = 5, kFan = 6;
constexpr std::array<uint8_t, 3> kWhite = {255, 255, 255};

/// Screens show colours that are not linear (IEC 61966-2-1), glTF's are.
uint8_t shown_of(double linear) {
  const double value = std::clamp(linear, 0.0, 1.0);
  const double shown = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
  return static_cast<uint8_t>(std::lround(255.0 * shown));
}

template <size_t n>
std::array<double, n> numbers_of(const nlohmann::json& node, const char* key, const std::array<double, n>& otherwise) {
  const auto found = node.find(key);
  return found == node.end() ? otherwise : found->get<std::array<double, n>>();
}

/// Finds where a node puts what is below it (glTF 2.0, 3.5.3).
Affine3d transform_of(const nlohmann::json& node) {
  Affine3d transform = Affine3d::Identity();
  if (node.contains("matrix")) {
    const auto columns = node.at("matrix").get<std::array<double, 16>>();
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 3; ++r) transform.matrix()(r, c) = columns[static_cast<size_t>(4 * c + r)];
    }
    return transform;
  }
  const auto t = numbers_of<3>(node, "translation", {0, 0, 0});
  const auto q = numbers_of<4>(node, "rotation", {0, 0, 0, 1});
  const auto s = numbers_of<3>(node, "scale", {1, 1, 1});
  return Eigen::Translation3d(t[0], t[1], t[2]) * Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized() *
         Eigen::Scaling(s[0], s[1], s[2]);
}

/// Puts the meshes of a scene together.
class SceneReader {
 public:
  explicit SceneReader(const GltfDocument& document) : document_(document), json_(document.json) {}

  absl::StatusOr<ColouredSurface> read() {
    for (const uint64_t root : roots()) {
      if (auto status = read_node(root, Affine3d::Identity(), 0); !status.ok()) return status;
    }
    if (surface_.triangles.empty()) return absl::InvalidArgumentError("holds no triangle");
    if (!has_colours_) surface_.colours.clear();
    if (json_.contains("textures")) remark("its textures are passed over: colours of vertices alone are kept");
    if (json_.contains("skins")) remark("its skins are passed over: the surface is taken as it is at rest");
    if (has_targets_) remark("its morph targets are passed over: the surface is taken as it is at rest");
    if (lines_ > 0) remark(absl::StrCat(lines_, " sets of points or lines are passed over"));
    return std::move(surface_);
  }

 private:
  void remark(std::string text) { surface_.remarks.push_back(std::move(text)); }

  /// The roots of the scene that the file shows; without scenes every node that is no child.
  std::vector<uint64_t> roots() const {
    const nlohmann::json scenes = json_.value("scenes", nlohmann::json::array());
    const auto shown = json_.value("scene", uint64_t{0});
    if (shown < scenes.size()) return scenes[static_cast<size_t>(shown)].value("nodes", std::vector<uint64_t>());
    std::vector<uint64_t> all(json_.value("nodes", nlohmann::json::array()).size());
    for (size_t k = 0; k < all.size(); ++k) all[k] = k;
    for (const nlohmann::json& node : json_.value("nodes", nlohmann::json::array())) {
      for (const uint64_t child : node.value("children", std::vector<uint64_t>())) std::erase(all, child);
    }
    return all;
  }

  absl::Status read_node(uint64_t index, const Affine3d& above, int depth) {
    const auto& nodes = json_.at("nodes");
    if (index >= nodes.size())
      return absl::InvalidArgumentError(absl::StrCat("names node ", index, " of ", nodes.size()));
    if (depth > kMaxDepth || ++visited_ > kMaxNodes)
      return absl::InvalidArgumentError("has nodes that are their own children, or too many of them");
    const nlohmann::json& node = nodes[static_cast<size_t>(index)];
    const Affine3d here = above * transform_of(node);
    if (node.contains("mesh")) {
      if (auto status = read_mesh(node.at("mesh").get<uint64_t>(), here); !status.ok()) return status;
    }
    for (const uint64_t child : node.value("children", std::vector<uint64_t>())) {
      if (auto status = read_node(child, here, depth + 1); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status read_mesh(uint64_t index, const Affine3d& place) {
    const auto& meshes = json_.at("meshes");
    if (index >= meshes.size())
      return absl::InvalidArgumentError(absl::StrCat("names mesh ", index, " of ", meshes.size()));
    for (const nlohmann::json& primitive : meshes[static_cast<size_t>(index)].at("primitives")) {
      const auto mode = primitive.value("mode", int64_t{kTriangles});
      has_targets_ = has_targets_ || primitive.contains("targets");
      if (mode < kTriangles || mode > kFan) {
        ++lines_;
        continue;
      }
      if (auto status = read_primitive(primitive, static_cast<int>(mode), place); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status read_primitive(const nlohmann::json& primitive, int mode, const Affine3d& place) {
    const nlohmann::json& attributes = primitive.at("attributes");
    const auto positions = read_gltf_accessor(document_, attributes.at("POSITION").get<size_t>(), "POSITION");
    if (!positions.ok()) return positions.status();
    if (positions->components != 3) return absl::InvalidArgumentError("has a POSITION that is no VEC3");
    const size_t first = surface_.points.size();
    if (positions->count() > kMaxPoints - first)
      return absl::InvalidArgumentError(absl::StrCat("has more than the ", kMaxPoints, " points allowed"));
    for (size_t k = 0; k < positions->count(); ++k) {
      const Vector3d point = place * Vector3d(positions->values.data() + 3 * k);
      if (!point.allFinite()) return absl::InvalidArgumentError("has a point that is not finite");
      surface_.points.push_back({point.x(), point.y(), point.z()});
    }
    if (auto status = read_colours(attributes, positions->count()); !status.ok()) return status;
    auto corners = read_corners(primitive, positions->count());
    if (!corners.ok()) return corners.status();
    // A transform that mirrors turns triangles inside out.
    add_triangles(*corners, mode, static_cast<uint32_t>(first), place.linear().determinant() < 0.0);
    return absl::OkStatus();
  }

  absl::Status read_colours(const nlohmann::json& attributes, size_t count) {
    const size_t wanted = surface_.points.size();
    if (!attributes.contains("COLOR_0")) {
      surface_.colours.resize(wanted, kWhite);
      return absl::OkStatus();
    }
    const auto colours = read_gltf_accessor(document_, attributes.at("COLOR_0").get<size_t>(), "COLOR_0");
    if (!colours.ok()) return colours.status();
    if (colours->components < 3 || colours->count() != count)
      return absl::InvalidArgumentError(absl::StrCat("has ", colours->count(), " colours for ", count, " points"));
    has_colours_ = true;
    for (size_t k = 0; k < count; ++k) {
      const double* const of = colours->values.data() + colours->components * k;
      surface_.colours.push_back({shown_of(of[0]), shown_of(of[1]), shown_of(of[2])});
    }
    return absl::OkStatus();
  }

  absl::StatusOr<std::vector<uint32_t>> read_corners(const nlohmann::json& primitive, size_t points) const {
    std::vector<uint32_t> corners;
    if (!primitive.contains("indices")) {
      for (size_t k = 0; k < points; ++k) corners.push_back(static_cast<uint32_t>(k));
      return corners;
    }
    const auto indices = read_gltf_accessor(document_, primitive.at("indices").get<size_t>(), "indices");
    if (!indices.ok()) return indices.status();
    for (const double index : indices->values) {
      if (!(index >= 0.0 && index < static_cast<double>(points)) || index != std::floor(index))
        return absl::InvalidArgumentError(absl::StrCat("has the index ", index, " into ", points, " points"));
      corners.push_back(static_cast<uint32_t>(index));
    }
    return corners;
  }

  void add_triangles(const std::vector<uint32_t>& corners, int mode, uint32_t first, bool turned) {
    const size_t step = mode == kTriangles ? 3 : 1;
    for (size_t k = 0; k + 2 < corners.size(); k += step) {
      std::array<uint32_t, 3> triangle = {corners[k], corners[k + 1], corners[k + 2]};
      if (mode == kStrip && k % 2 == 1) std::swap(triangle[1], triangle[2]);
      if (mode == kFan) triangle[0] = corners[0];
      if (turned) std::swap(triangle[1], triangle[2]);
      for (uint32_t& corner : triangle) corner += first;
      surface_.triangles.push_back(triangle);
    }
  }

  const GltfDocument& document_;
  const nlohmann::json& json_;
  ColouredSurface surface_;
  bool has_colours_ = false, has_targets_ = false;
  size_t lines_ = 0, visited_ = 0;
};

template <typename Value>
void append(std::string* bytes, const Value& value) {
  const size_t at = bytes->size();
  bytes->resize(at + sizeof value);
  std::memcpy(bytes->data() + at, &value, sizeof value);
}

}  // namespace

bool is_gltf_name(const std::filesystem::path& file) {
  const std::string ending = absl::AsciiStrToLower(file.extension().string());
  return ending == ".glb" || ending == ".gltf";
}

absl::StatusOr<ColouredSurface> read_gltf_surface(const std::filesystem::path& file) {
  absl::StatusOr<ColouredSurface> surface = absl::InvalidArgumentError("");
  try {
    const auto document = read_gltf_document(file);
    surface = document.ok() ? SceneReader(*document).read() : document.status();
  } catch (const nlohmann::json::exception& exception) {
    surface = absl::InvalidArgumentError(absl::StrCat("is no glTF: ", exception.what()));
  }
  if (!surface.ok()) return absl::InvalidArgumentError(absl::StrCat(file.string(), " ", surface.status().message()));
  return surface;
}

std::string ply_bytes(const ColouredSurface& surface, double scale) {
  const bool coloured = !surface.colours.empty();
  std::string bytes =
      absl::StrCat("ply\nformat binary_little_endian 1.0\nelement vertex ", surface.points.size(),
                   "\nproperty double x\nproperty double y\nproperty double z\n",
                   coloured ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "", "element face ",
                   surface.triangles.size(), "\nproperty list uchar uint vertex_indices\nend_header\n");
  for (size_t k = 0; k < surface.points.size(); ++k) {
    for (const double coordinate : surface.points[k]) append(&bytes, scale * coordinate);
    if (coloured) append(&bytes, surface.colours[k]);
  }
  for (const auto& triangle : surface.triangles) {
    append(&bytes, uint8_t{3});
    append(&bytes, triangle);
  }
  return bytes;
}

double gltf_unit_mm(const ColouredSurface& surface, double stated_mm) {
  Vector3d least = Vector3d::Constant(std::numeric_limits<double>::infinity()), most = -least;
  for (const auto& triangle : surface.triangles) {
    for (const uint32_t corner : triangle) {
      const Vector3d point(surface.points[corner].data());
      least = least.cwiseMin(point);
      most = most.cwiseMax(point);
    }
  }
  return (most - least).maxCoeff() < kLargestInMetres ? kMmPerMetre : stated_mm;
}

}  // namespace lipofill::client
