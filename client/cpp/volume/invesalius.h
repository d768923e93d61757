#pragma once

#include <array>
#include <filesystem>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// Content of a project.
struct InvesaliusVolume {
  std::array<uint64_t, 3> size{};  ///< columns, rows, slices
  std::array<double, 3> spacing_mm{};
};

/// Writes the volume of an InVesalius 3 project (.inv3) as a MetaImage (.mha) in LPS axes. The
/// project is a gzipped tar of main.plist and a matrix of int16 (slice, row, column); its rows
/// count forward, so they are written in reverse order: y grows to the back and the head is not
/// mirrored, also for readers that ignore a direction matrix. Streams: memory for one slice.
/// INVALID_ARGUMENT for a file that is no such project, is cut short, or whose matrix is not axial
/// int16 of the size the project says. Checked by tests/unit/client/invesalius_test.cc.
absl::StatusOr<InvesaliusVolume> convert_invesalius(const std::filesystem::path& project,
                                                    const std::filesystem::path& out);

}  // namespace lipofill::client
