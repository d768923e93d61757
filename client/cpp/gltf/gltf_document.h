#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// A glTF 2.0 file: its JSON, and the bytes of its buffers.
struct GltfDocument {
  nlohmann::json json;
  std::vector<std::string> buffers;
};

/// Bytes that a file and each of its buffers may have.
inline constexpr size_t kMaxGltfBytes = size_t{256} << 20;

/// Reads a .glb, or a .gltf with its buffers as data URIs or as files beside it: a buffer elsewhere
/// is not opened, for a scan from outside must not name files of this machine. INVALID_ARGUMENT,
/// without the file's name, for what is none, is of another version, is cut short, or asks for an
/// extension that changes how vertices are stored (Draco, meshopt). Checked by
/// tests/unit/client/gltf_test.cc and tests/fuzz/gltf_fuzzer.cc.
absl::StatusOr<GltfDocument> read_gltf_document(const std::filesystem::path& file);

}  // namespace lipofill::client
