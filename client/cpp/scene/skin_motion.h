#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// The skin at a time.
struct SkinStill {
  double time_s = 0.0;
  Eigen::Matrix3Xf displacement_mm;
};

/// The skin of a result as it moves: the whole scan, or the model's skin where there is no scan.
struct SkinMotion {
  Eigen::Matrix3Xd rest_mm;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<SkinStill> stills;     ///< by time, the last is the result
  std::vector<double> pressure_pa;   ///< of the fat below each point in the last still; 0 without fat
  std::vector<double> thickness_mm;  ///< of the fat below each point in the last still
};

/// Reads the skin of a folder of results.
/// @param most_stills  at least 1; of more, so many are taken, evenly, the last among them
/// INVALID_ARGUMENT, naming the file, for a folder that no run has written. Checked by
/// tests/unit/client/scene_test.cc.
absl::StatusOr<SkinMotion> read_skin_motion(const std::filesystem::path& folder, size_t most_stills);

}  // namespace lipofill::client
