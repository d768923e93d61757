#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace lipofill::client {

/// A map of thickness.
struct ThicknessMap {
  std::string field;    ///< a point field in mm, not a number where the default stands
  std::string heading;  ///< the layer
  std::string figures;  ///< its spread, and how much of it was measured
};

struct ThicknessPicture {
  std::filesystem::path mesh;  ///< a .vtp with the fields
  std::filesystem::path png;
  std::string title, caption;
  std::vector<ThicknessMap> maps;  ///< at most kMostThicknessMaps are drawn
  std::vector<std::string> remarks;
  std::optional<std::array<double, 3>> up;
};

inline constexpr size_t kMostThicknessMaps = 4;

/// Draws maps of the thickness of layers side by side on the skin, grey where nothing was measured
/// and the default stands. Needs an X server, as the other pictures. INVALID_ARGUMENT for a mesh
/// that cannot be read or lacks a field. Checked by tests/python/test_thickness.py.
absl::Status draw_thickness_picture(const ThicknessPicture& picture);

}  // namespace lipofill::client
