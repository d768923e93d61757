#pragma once

#include <filesystem>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/volume/volume_reader.h"

namespace lipofill::client {

/// Turns a label map, in which every voxel has the number of what it belongs to, into a mask: 1 in
/// voxels of the labels wanted, of every label but 0 where the list is empty, and 0 in all others;
/// its surface lies at 0.5. INVALID_ARGUMENT, with
/// the labels there are, for a label that no voxel has, or for a volume with more than 4096 values,
/// which is no label map. Checked by tests/unit/client/volume_kinds_test.cc.
absl::StatusOr<Volume> mask_labels(const std::filesystem::path& source, const Volume& map,
                                   const std::vector<int64_t>& labels);

}  // namespace lipofill::client
