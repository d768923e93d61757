#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// Tells whether `scan check` has a volume before it: a file of a volume, or DICOM.
bool holds_a_volume(const std::filesystem::path& source);

/// Tells programs what was found in a volume: its series where it is DICOM, size, spacing, values,
/// labels with the tissues they are understood as, and remarks. Draws its middle slices where `png`
/// names a file.
absl::StatusOr<nlohmann::ordered_json> check_volume(const std::filesystem::path& source, const std::string& series,
                                                    const std::filesystem::path& png);

/// The same for people.
std::string describe_volume(const nlohmann::ordered_json& found);

}  // namespace lipofill::client
