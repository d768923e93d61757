#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::client {

/// The bytes of a text file of at most 64 MiB. INVALID_ARGUMENT naming the file.
absl::StatusOr<std::string> read_text_file(const std::filesystem::path& file);

/// Reads a JSON file. INVALID_ARGUMENT naming the file, the line and the column for anything else.
absl::StatusOr<nlohmann::json> read_json_file(const std::filesystem::path& file);

/// Writes a file through a temporary one beside it, so that a reader never sees half of it.
absl::Status write_text_file(const std::filesystem::path& file, const std::string& text);

}  // namespace lipofill::client
