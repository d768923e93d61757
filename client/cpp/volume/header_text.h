#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::client {

/// The text in front of a volume's voxels: "key = value" or "key: value" lines.
struct HeaderText {
  std::string first_line;
  std::map<std::string, std::string> values;  ///< keys in lower case
  uint64_t end = 0;                           ///< offset of the first byte after it

  std::string value(const std::string& key) const;
  bool has(const std::string& key) const { return values.count(key) > 0; }
};

/// Reads lines up to one that begins with the key `last_key`, or an empty one; at most 64 KiB.
absl::StatusOr<HeaderText> read_header_text(const std::filesystem::path& file, char separator,
                                            const std::string& last_key);

/// Numbers separated by spaces, commas or brackets; none for anything that is not a finite number.
std::optional<std::vector<double>> parse_numbers(const std::string& text);

/// Three sizes of at least 1, whose product is bounded.
absl::StatusOr<std::array<uint64_t, 3>> parse_sizes(const std::filesystem::path& file, const std::string& key,
                                                    const std::string& text);

absl::Status bad_volume(const std::filesystem::path& file, const std::string& what);

}  // namespace lipofill::client
