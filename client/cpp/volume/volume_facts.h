#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "absl/status/status.h"
#include "client/cpp/volume/value_range.h"
#include "client/cpp/volume/volume_reader.h"

namespace lipofill::client {

/// These facts tell what a volume holds.
struct VolumeFacts {
  std::array<int, 3> size{};
  std::array<double, 3> spacing_mm{};  ///< along its three axes; the mean where slices are uneven
  std::string frame;
  ValueRange values;
  /// Voxels of each label, where a volume names labels or has few values, all of them whole.
  std::map<int64_t, uint64_t> labels;
  double voxel_ml = 0.0;
};

/// More different values than this are no labels, unless they are named.
inline constexpr size_t kMostLabels = 64;

/// Passes over the voxels a few times. Checked by tests/unit/client/volume_facts_test.cc.
VolumeFacts find_volume_facts(const Volume& volume);

/// Draws the three slices through the middle of a volume side by side, each 600 pixels high at
/// most, true to its millimetres: values from the least, or -300 where there is less, to the
/// greatest, or 1500, as grey; labels in colours. Needs no screen. INVALID_ARGUMENT for a file that
/// cannot be written. Checked by tests/unit/client/volume_facts_test.cc.
absl::Status draw_slices(const Volume& volume, const VolumeFacts& facts, const std::filesystem::path& png);

}  // namespace lipofill::client
