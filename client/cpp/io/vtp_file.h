#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <filesystem>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// Reads a .vtp with whatever fields it has. INVALID_ARGUMENT, naming the file, for one that cannot
/// be read or has no points. Checked by tests/integration/cli/render_test.cc,
/// tests/unit/client/records_test.cc and tests/unit/client/scene_test.cc.
absl::StatusOr<vtkSmartPointer<vtkPolyData>> read_vtp(const std::filesystem::path& file);

}  // namespace lipofill::client
