#pragma once

#include <array>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// x, y, z of a vertex of a PLY, then red, green and blue from 0 to 255.
using PlyVertex = std::array<double, 6>;

/// Reads the vertices of a PLY, ASCII or binary of either order of bytes, with their colours.
/// INVALID_ARGUMENT for one without colours, whose vertices are not its first element, or that
/// holds fewer than it says. Nothing is taken that the file only promises. Checked by
/// tests/unit/client/scan_colours_test.cc and tests/fuzz/ply_colours_fuzzer.cc.
absl::StatusOr<std::vector<PlyVertex>> read_ply_colours(const std::string& bytes);

}  // namespace lipofill::client
