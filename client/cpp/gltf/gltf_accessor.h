#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/cpp/gltf/gltf_document.h"

namespace lipofill::client {

/// The numbers of an accessor, as it declares them (glTF 2.0, 3.6.2): every byte that is read lies
/// within its buffer view and this within its buffer.
struct GltfNumbers {
  std::vector<double> values;  ///< (count, components), normalised where the accessor says so
  size_t components = 0;
  size_t count() const { return components == 0 ? 0 : values.size() / components; }
};

/// Elements that an accessor may have.
inline constexpr size_t kMaxGltfElements = 60'000'000;

/// Reads an accessor of "SCALAR", "VEC2", "VEC3" or "VEC4". INVALID_ARGUMENT for one that is not
/// there, lies outside of its buffer, is sparse, or is of another type; nlohmann's exceptions for a
/// field of another kind. Checked by tests/unit/client/gltf_test.cc and tests/fuzz/gltf_fuzzer.cc.
/// @param what  "POSITION" and the like, for messages
absl::StatusOr<GltfNumbers> read_gltf_accessor(const GltfDocument& document, size_t accessor, absl::string_view what);

}  // namespace lipofill::client
