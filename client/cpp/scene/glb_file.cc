#include "client/cpp/scene/glb_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lipofill::client {
namespace {

constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;
constexpr uint32_t kMagic = 0x46546C67;  // "glTF"
constexpr uint32_t kJson = 0x4E4F534A;
constexpr uint32_t kBinary = 0x004E4942;

void append(std::string* bytes, uint32_t value) {
  char word[4];
  std::memcpy(word, &value, 4);
  bytes->append(word, 4);
}

void pad(std::string* bytes, char with) {
  bytes->resize((bytes->size() + 3) / 4 * 4, with);
}

nlohmann::ordered_json numbers(const Eigen::Vector3f& values) {
  return {values[0], values[1], values[2]};
}

}  // namespace

int GlbFile::add(const void* data, size_t bytes, Target target, nlohmann::ordered_json accessor) {
  nlohmann::ordered_json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes}};
  if (target != Target::kNone) view["target"] = static_cast<int>(target);
  accessor["bufferView"] = views_.size();
  binary_.append(static_cast<const char*>(data), bytes);
  pad(&binary_, '\0');
  views_.push_back(std::move(view));
  accessors_.push_back(std::move(accessor));
  return static_cast<int>(accessors_.size()) - 1;
}

int GlbFile::add_vectors(const Eigen::Matrix3Xf& values) {
  return add(values.data(), static_cast<size_t>(values.size()) * sizeof(float), Target::kVertices,
             {{"componentType", kFloat},
              {"count", values.cols()},
              {"type", "VEC3"},
              {"min", numbers(values.rowwise().minCoeff())},
              {"max", numbers(values.rowwise().maxCoeff())}});
}

int GlbFile::add_colours(const Eigen::Matrix4Xf& values) {
  std::vector<uint16_t> codes;
  codes.reserve(static_cast<size_t>(values.size()));
  for (const float value : values.reshaped())
    codes.push_back(static_cast<uint16_t>(std::lround(std::clamp(value, 0.0F, 1.0F) * 65535.0F)));
  return add(codes.data(), codes.size() * sizeof(uint16_t), Target::kVertices,
             {{"componentType", kUnsignedShort}, {"normalized", true}, {"count", values.cols()}, {"type", "VEC4"}});
}

int GlbFile::add_indices(const std::vector<std::array<uint32_t, 3>>& triangles) {
  return add(triangles.data(), triangles.size() * sizeof triangles[0], Target::kIndices,
             {{"componentType", kUnsignedInt}, {"count", 3 * triangles.size()}, {"type", "SCALAR"}});
}

int GlbFile::add_scalars(const std::vector<float>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return add(
      values.data(), values.size() * sizeof(float), Target::kNone,
      {{"componentType", kFloat}, {"count", values.size()}, {"type", "SCALAR"}, {"min", {*least}}, {"max", {*most}}});
}

std::string GlbFile::bytes(nlohmann::ordered_json scene) const {
  scene["accessors"] = accessors_;
  scene["bufferViews"] = views_;
  scene["buffers"] = {{{"byteLength", binary_.size()}}};
  std::string text = scene.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  pad(&text, ' ');
  std::string file;
  append(&file, kMagic);
  append(&file, 2);
  append(&file, static_cast<uint32_t>(12 + 8 + text.size() + 8 + binary_.size()));
  append(&file, static_cast<uint32_t>(text.size()));
  append(&file, kJson);
  file += text;
  append(&file, static_cast<uint32_t>(binary_.size()));
  append(&file, kBinary);
  return file + binary_;
}

}  // namespace lipofill::client
