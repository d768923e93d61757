#include "client/cpp/gltf/gltf_document.h"

#include <cstring>
#include <fstream>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace lipofill::client {
namespace {

constexpr size_t kHeadBytes = 12;
constexpr size_t kChunkHeadBytes = 8;
constexpr uint32_t kJsonChunk = 0x4E4F534A;
constexpr uint32_t kBinaryChunk = 0x004E4942;
constexpr size_t kMaxBuffers = 64;

uint32_t word_at(const std::string& bytes, size_t at) {
  uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

absl::StatusOr<std::string> read_bytes(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::is_regular_file(file, error) ? std::filesystem::file_size(file, error) : 0;
  if (error || !std::filesystem::is_regular_file(file, error))
    return absl::InvalidArgumentError("does not exist or is not a file");
  if (size > kMaxGltfBytes)
    return absl::InvalidArgumentError(absl::StrCat("has ", size, " bytes, more than the ", kMaxGltfBytes, " allowed"));
  std::string bytes(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size)))
    return absl::InvalidArgumentError("cannot be read");
  return bytes;
}

/// The chunks of a GLB: a JSON, and perhaps a binary one (glTF 2.0, 4.4).
struct Chunks {
  std::string json;
  std::string binary;
  bool has_binary = false;
};

absl::StatusOr<Chunks> split_chunks(const std::string& bytes) {
  if (bytes.size() < kHeadBytes) return absl::InvalidArgumentError("is cut short");
  if (const uint32_t version = word_at(bytes, 4); version != 2)
    return absl::InvalidArgumentError(absl::StrCat("is of glTF version ", version, "; 2 is read"));
  Chunks chunks;
  for (size_t at = kHeadBytes; at + kChunkHeadBytes <= bytes.size();) {
    const uint32_t size = word_at(bytes, at);
    const uint32_t kind = word_at(bytes, at + 4);
    at += kChunkHeadBytes;
    if (size > bytes.size() - at) {
      return absl::InvalidArgumentError(
          absl::StrCat("is cut short: a chunk has ", size, " bytes, of which ", bytes.size() - at, " are there"));
    }
    if (kind == kJsonChunk && chunks.json.empty()) {
      chunks.json = bytes.substr(at, size);
    } else if (kind == kBinaryChunk && !chunks.has_binary) {
      chunks.binary = bytes.substr(at, size);
      chunks.has_binary = true;
    }
    at += size;
  }
  return chunks;
}

absl::StatusOr<std::string> buffer_of_uri(const std::string& uri, const std::filesystem::path& folder) {
  if (absl::StartsWith(uri, "data:")) {
    const size_t comma = uri.find(',');
    std::string bytes;
    if (comma == std::string::npos || !absl::StrContains(uri.substr(0, comma), ";base64") ||
        !absl::Base64Unescape(absl::string_view(uri).substr(comma + 1), &bytes)) {
      return absl::InvalidArgumentError("has a buffer whose data URI is not base64");
    }
    return bytes;
  }
  const std::filesystem::path name(uri);
  if (name.empty() || name.has_parent_path() || name.filename() != name || uri == "." || uri == "..") {
    return absl::InvalidArgumentError(
        "has a buffer in another folder; export it as .glb, which holds everything in one file");
  }
  auto bytes = read_bytes(folder / name);
  if (!bytes.ok())
    return absl::InvalidArgumentError(absl::StrCat("has a buffer beside it that ", bytes.status().message()));
  return bytes;
}

absl::Status take_buffers(const Chunks& chunks, const std::filesystem::path& folder, GltfDocument* document) {
  const nlohmann::json buffers = document->json.value("buffers", nlohmann::json::array());
  if (buffers.size() > kMaxBuffers)
    return absl::InvalidArgumentError(
        absl::StrCat("has ", buffers.size(), " buffers, more than the ", kMaxBuffers, " allowed"));
  size_t total = 0;
  for (const nlohmann::json& buffer : buffers) {
    const auto length = buffer.at("byteLength").get<uint64_t>();
    absl::StatusOr<std::string> bytes = chunks.binary;
    if (buffer.contains("uri")) {
      bytes = buffer_of_uri(buffer.at("uri").get<std::string>(), folder);
    } else if (!chunks.has_binary || !document->buffers.empty()) {
      return absl::InvalidArgumentError("has a buffer that is nowhere");
    }
    if (!bytes.ok()) return bytes.status();
    if (length > bytes->size()) {
      return absl::InvalidArgumentError(
          absl::StrCat("is cut short: a buffer has ", length, " bytes, of which ", bytes->size(), " are there"));
    }
    total += bytes->size();
    if (total > kMaxGltfBytes) return absl::InvalidArgumentError("has more bytes in its buffers than are allowed");
    document->buffers.push_back(*std::move(bytes));
  }
  return absl::OkStatus();
}

absl::Status check_extensions(const nlohmann::json& json) {
  for (const nlohmann::json& name : json.value("extensionsRequired", nlohmann::json::array())) {
    const auto extension = name.get<std::string>();
    if (absl::StrContains(extension, "draco") || absl::StrContains(extension, "meshopt") ||
        absl::StrContains(extension, "quantization")) {
      return absl::InvalidArgumentError(
          absl::StrCat("packs its vertices with ", extension, ", which is not read; export it without compression"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<GltfDocument> read_gltf_document(const std::filesystem::path& file) {
  const auto bytes = read_bytes(file);
  if (!bytes.ok()) return bytes.status();
  Chunks chunks;
  if (absl::StartsWith(*bytes, "glTF")) {
    auto split = split_chunks(*bytes);
    if (!split.ok()) return split.status();
    chunks = *std::move(split);
  } else {
    chunks.json = *bytes;
  }
  try {
    GltfDocument document;
    document.json = nlohmann::json::parse(chunks.json);
    const auto version = document.json.at("asset").at("version").get<std::string>();
    if (!absl::StartsWith(version, "2."))
      return absl::InvalidArgumentError(absl::StrCat("is of glTF version '", version, "'; 2.0 is read"));
    if (auto status = check_extensions(document.json); !status.ok()) return status;
    if (auto status = take_buffers(chunks, file.parent_path(), &document); !status.ok()) return status;
    return document;
  } catch (const nlohmann::json::exception& exception) {
    return absl::InvalidArgumentError(absl::StrCat("is no glTF: ", exception.what()));
  }
}

}  // namespace lipofill::client
