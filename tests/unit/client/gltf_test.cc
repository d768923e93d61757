// Surfaces of glTF files: every kind of primitive, nodes, colours, and what is refused.

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "absl/strings/escaping.h"
#include "client/cpp/gltf/gltf_surface.h"
#include "temporary_folder.h"

namespace lipofill::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;

template <typename Value>
std::string packed(const std::vector<Value>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

/// A quadrilateral of 0.1 x 0.2 m as two triangles, to be changed.
class GltfTest : public TemporaryFolderTest {
 protected:
  void SetUp() override {
    TemporaryFolderTest::SetUp();
    document_ = Json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]})");
    add(packed<float>({0, 0, 0, 0.1F, 0, 0, 0.1F, 0.2F, 0, 0, 0.2F, 0.05F}), 5126, 4, "VEC3");
    add(packed<uint16_t>({0, 1, 2, 0, 2, 3}), 5123, 6, "SCALAR");
  }

  int add(const std::string& bytes, int component_type, int count, const std::string& type) {
    Json& views = document_["bufferViews"];
    views.push_back({{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}});
    binary_ += bytes + std::string((4 - bytes.size() % 4) % 4, '\0');
    Json& accessors = document_["accessors"];
    accessors.push_back(
        {{"bufferView", views.size() - 1}, {"componentType", component_type}, {"count", count}, {"type", type}});
    return static_cast<int>(accessors.size()) - 1;
  }

  Json& primitive() { return document_["meshes"][0]["primitives"][0]; }

  std::string glb() const {
    Json document = document_;
    document["buffers"] = {{{"byteLength", binary_.size()}}};
    std::string text = document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto size = [](size_t value) { return static_cast<uint32_t>(value); };
    return packed<uint32_t>({0x46546C67, 2, size(28 + text.size() + binary_.size()), size(text.size()), 0x4E4F534A}) +
           text + packed<uint32_t>({size(binary_.size()), 0x004E4942}) + binary_;
  }

  absl::StatusOr<ColouredSurface> read() const { return read_gltf_surface(write("face.glb", glb())); }
  ColouredSurface surface() const {
    auto read_now = read();
    EXPECT_TRUE(read_now.ok()) << read_now.status();
    return read_now.ok() ? *std::move(read_now) : ColouredSurface();
  }
  std::string refusal() const {
    const auto refused = read();
    EXPECT_EQ(refused.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(refused.status().message());
  }

  Json document_;
  std::string binary_;
};

using Corners = std::array<uint32_t, 3>;

TEST_F(GltfTest, TrianglesStripsAndFansFaceTheSameWay) {
  EXPECT_THAT(surface().triangles, ElementsAre(Corners{0, 1, 2}, Corners{0, 2, 3}));
  primitive()["indices"] = add(packed<uint8_t>({0, 1, 3, 2}), 5121, 4, "SCALAR");
  primitive()["mode"] = 5;
  EXPECT_THAT(surface().triangles, ElementsAre(Corners{0, 1, 3}, Corners{1, 2, 3}));
  primitive()["indices"] = add(packed<uint32_t>({0, 1, 2, 3}), 5125, 4, "SCALAR");
  primitive()["mode"] = 6;
  EXPECT_THAT(surface().triangles, ElementsAre(Corners{0, 1, 2}, Corners{0, 2, 3}));
  primitive().erase("indices");
  EXPECT_THAT(surface().triangles, ElementsAre(Corners{0, 1, 2}, Corners{0, 2, 3}));
}

TEST_F(GltfTest, NodesPutMeshesWhereTheyAre) {
  // Turned by a quarter about z, twice as large, moved; then mirrored by its parent.
  document_["nodes"] = Json::parse(R"([{"children": [1], "scale": [-1, 1, 1]},
    {"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "scale": [2, 2, 2]}])");
  const ColouredSurface found = surface();
  EXPECT_NEAR(found.points[1][0], -1.0, 1e-7);
  EXPECT_NEAR(found.points[1][1], 2.2, 1e-7);
  EXPECT_NEAR(found.points[1][2], 3.0, 1e-7);
  EXPECT_THAT(found.triangles[0], ElementsAre(0, 2, 1));
  document_["nodes"] = Json::parse(R"([{"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 7,8,9,1]}])");
  EXPECT_NEAR(surface().points[0][2], 9.0, 1e-9);
}

TEST_F(GltfTest, ColoursAreThoseOfScreens) {
  primitive()["attributes"]["COLOR_0"] =
      add(packed<float>({1, 0, 0, 0, 1, 0, 0.2158605F, 0.2158605F, 0.2158605F, 2, 0, 0}), 5126, 4, "VEC3");
  const ColouredSurface found = surface();
  ASSERT_EQ(found.colours.size(), 4U);
  EXPECT_THAT(found.colours[0], ElementsAre(255, 0, 0));
  EXPECT_THAT(found.colours[2], ElementsAre(128, 128, 128));
  EXPECT_THAT(found.colours[3], ElementsAre(255, 0, 0));
  const std::string ply = ply_bytes(found, 1000.0);
  EXPECT_THAT(ply, HasSubstr("element vertex 4\nproperty double x"));
  EXPECT_THAT(ply, HasSubstr("property uchar red"));
  const size_t head = ply.find("end_header\n") + 11;
  EXPECT_EQ(ply.size(), head + 4 * (24 + 3) + 2 * 13);
  double x = 0.0;
  std::memcpy(&x, ply.data() + head + 27, sizeof x);
  EXPECT_NEAR(x, 100.0, 1e-5);
}

TEST_F(GltfTest, WhatIsPassedOverIsSaid) {
  document_["textures"] = Json::array({Json::object()});
  primitive()["targets"] = Json::array({{{"POSITION", 0}}});
  document_["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  const std::string remarks = Json(surface().remarks).dump();
  EXPECT_THAT(remarks, HasSubstr("textures are passed over"));
  EXPECT_THAT(remarks, HasSubstr("morph targets are passed over"));
  EXPECT_THAT(remarks, HasSubstr("1 sets of points or lines"));
}

TEST_F(GltfTest, AGltfHasItsBufferInItOrBesideItAndNowhereElse) {
  Json document = document_;
  document["buffers"] = {{{"byteLength", binary_.size()}, {"uri", "face.bin"}}};
  write("face.bin", binary_);
  EXPECT_TRUE(read_gltf_surface(write("face.gltf", document.dump())).ok());
  document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + absl::Base64Escape(binary_);
  EXPECT_TRUE(read_gltf_surface(write("face.gltf", document.dump())).ok());
  for (const char* const elsewhere : {"../face.bin", "/etc/passwd", "..", "a/b", "file:///etc/passwd"}) {
    document["buffers"][0]["uri"] = elsewhere;
    EXPECT_THAT(std::string(read_gltf_surface(write("face.gltf", document.dump())).status().message()),
                HasSubstr("another folder"))
        << elsewhere;
  }
}

TEST_F(GltfTest, UnitsFollowFromTheSize) {
  ColouredSurface found = surface();
  EXPECT_EQ(gltf_unit_mm(found, 1.0), 1000.0);
  for (auto& point : found.points) {
    for (double& coordinate : point) coordinate *= 1000.0;
  }
  EXPECT_EQ(gltf_unit_mm(found, 1.0), 1.0);
  EXPECT_EQ(gltf_unit_mm(found, 10.0), 10.0);
}

TEST_F(GltfTest, DamagedFilesAreRefusedWithWhatIsWrong) {
  const auto changed = [this](const Json::json_pointer& where, const Json& value) {
    const Json before = document_;
    document_[where] = value;
    const std::string message = refusal();
    document_ = before;
    return message;
  };
  using P = Json::json_pointer;
  EXPECT_THAT(changed(P("/accessors/0/count"), 5), HasSubstr("POSITION that reaches beyond its buffer view of 48"));
  EXPECT_THAT(changed(P("/accessors/0/count"), 1ULL << 62), HasSubstr("elements, more than"));
  EXPECT_THAT(changed(P("/accessors/0/byteOffset"), ~0ULL - 7), HasSubstr("reaches beyond"));
  EXPECT_THAT(changed(P("/bufferViews/0/byteOffset"), ~0ULL - 7), HasSubstr("reaches beyond its buffer"));
  EXPECT_THAT(changed(P("/bufferViews/0/byteStride"), 1), HasSubstr("byteStride of 1"));
  EXPECT_THAT(changed(P("/accessors/0/componentType"), 1), HasSubstr("component type 1"));
  EXPECT_THAT(changed(P("/accessors/0/sparse"), Json::object()), HasSubstr("is sparse"));
  const Json elsewhere = {
      {"bufferView", 0}, {"byteOffset", 12}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}};
  EXPECT_THAT(changed(P("/accessors/1"), elsewhere), HasSubstr("has the index 52429 into 4 points"));
  EXPECT_THAT(changed(P("/nodes/0/children"), {0}), HasSubstr("their own children"));
  EXPECT_THAT(changed(P("/nodes/0/mesh"), 3), HasSubstr("mesh 3 of 1"));
  EXPECT_THAT(changed(P("/scenes/0/nodes"), {7}), HasSubstr("node 7 of 1"));
  EXPECT_THAT(changed(P("/meshes/0/primitives/0/mode"), 0), HasSubstr("holds no triangle"));
  EXPECT_THAT(changed(P("/asset/version"), "1.0"), HasSubstr("version '1.0'"));
  EXPECT_THAT(changed(P("/extensionsRequired"), {"KHR_draco_mesh_compression"}), HasSubstr("without compression"));
  EXPECT_THAT(changed(P("/meshes"), "none"), HasSubstr("is no glTF"));
  const std::string whole = glb();
  for (size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(read_gltf_surface(write("cut.glb", whole.substr(0, size))).ok()) << size;
}

}  // namespace
}  // namespace lipofill::client
