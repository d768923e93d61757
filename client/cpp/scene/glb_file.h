#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lipofill::client {

/// Collects the binary part of a GLB (glTF 2.0): each array has a buffer view and an accessor of
/// its own, aligned to four bytes. Checked by tests/unit/client/scene_test.cc and, with Khronos'
/// validator, by tests/python/test_scenes.py.
class GlbFile {
 public:
  /// A VEC3 of floats for vertices, with its bounds, which POSITION must have.
  int add_vectors(const Eigen::Matrix3Xf& values);
  /// A normalised VEC4 of 16 bits, each column from 0 to 1.
  int add_colours(const Eigen::Matrix4Xf& values);
  /// A SCALAR of 32-bit indices into vertices.
  int add_indices(const std::vector<std::array<uint32_t, 3>>& triangles);
  /// A SCALAR of floats for animations, with its bounds, which the input of a sampler must have.
  int add_scalars(const std::vector<float>& values);

  /// The whole file: the JSON of the scene with accessors, buffer views and the buffer put in.
  std::string bytes(nlohmann::ordered_json scene) const;

 private:
  enum class Target { kNone = 0, kVertices = 34962, kIndices = 34963 };
  int add(const void* data, size_t bytes, Target target, nlohmann::ordered_json accessor);

  std::string binary_;
  nlohmann::ordered_json views_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json accessors_ = nlohmann::ordered_json::array();
};

}  // namespace lipofill::client
