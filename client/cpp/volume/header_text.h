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
#include "absl/strings/string_view.h"

namespace lipofill::client {

/// The text in front of a volume's voxels: "key = value" or "key: value" lines.
struct HeaderText {
  std::string first_line;
  std::map<std::string, std::string> values;  ///< keys in lower case
  std::map<std::string, std::string> notes;   ///< "key:=value" of a NRRD, keys as they are written
  std::vector<std::string> files;             ///< the lines behind a data file that is LIST, a file each
  uint64_t end = 0;                           ///< offset of the first byte after it

  std::string value(const std::string& key) const;
  bool has(const std::string& key) const { return values.count(key) > 0; }
  /// The value of the first of several spellings of the same key; empty where there is none.
  std::string first_of(std::initializer_list<const char*> keys) const;
};

enum class HeaderDialect {
  kNrrd,       ///< "field: value"; "key:=value" and "# ..." are notes; an empty line ends it
  kMetaImage,  ///< "Key = value" or "Key: value"; the line of ElementDataFile ends it
};

/// Reads the header in front of the voxels or in a file of its own; at most 1 MiB.
absl::StatusOr<HeaderText> read_header_text(const std::filesystem::path& file, HeaderDialect dialect);

/// Numbers separated by spaces, commas or brackets; none for anything that is not a finite number.
std::optional<std::vector<double>> parse_numbers(const std::string& text);

/// Whole numbers of [1, 65535], as many as there are; INVALID_ARGUMENT for others.
absl::StatusOr<std::vector<uint64_t>> parse_sizes(const std::filesystem::path& file, const std::string& key,
                                                  const std::string& text);

/// The sizes of the three axes, each of at least 2. Axes beyond the third may have one sample
/// each; with more the file holds several volumes and is refused.
absl::StatusOr<std::array<uint64_t, 3>> three_sizes(const std::filesystem::path& file, const std::string& key,
                                                    const std::vector<uint64_t>& sizes);

/// A whole number in [least, most], or `otherwise` for no text. INVALID_ARGUMENT for others.
absl::StatusOr<int64_t> parse_count(const std::filesystem::path& file, const std::string& key, const std::string& text,
                                    int64_t least, int64_t most, int64_t otherwise);

/// The files that a header names beside itself: `name` alone, the lines of a LIST, or the numbers
/// "first last step" in a pattern such as slice.%03d.raw. INVALID_ARGUMENT for another pattern, or
/// more than 65535 files.
absl::StatusOr<std::vector<std::filesystem::path>> data_files(const std::filesystem::path& file,
                                                              const std::string& name,
                                                              const std::vector<std::string>& list);

absl::Status bad_volume(const std::filesystem::path& file, absl::string_view what);

}  // namespace lipofill::client
