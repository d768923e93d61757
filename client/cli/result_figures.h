#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lipofill::client {

/// Returns the figures beside the panels of a result's picture, from the summary.json of its
/// folder: volume injected, movement of the skin, volume and pressure of each zone. Empty where the
/// folder has no summary that can be read: the picture is then drawn without.
std::vector<std::pair<std::string, std::string>> figures_of_folder(const std::filesystem::path& folder);

/// Returns the remarks on a result, from the summary.json of its folder; none where there is no
/// such summary.
std::vector<std::string> remarks_of_folder(const std::filesystem::path& folder);

}  // namespace lipofill::client
