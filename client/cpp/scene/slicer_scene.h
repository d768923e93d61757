#pragma once

#include <filesystem>
#include <optional>

#include "absl/status/status.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/scene/skin_motion.h"

namespace lipofill::client {

/// Writes a scene of 3D Slicer: FILE.mrml, and beside it FILE_before.vtp, FILE_planned.vtp with
/// "lift_mm" and "pressure_pa" on its points, coloured by lift, and FILE_landmarks.mrk.json where
/// there are landmarks. All are in LPS, which the scene and the files say. INVALID_ARGUMENT where
/// a file cannot be written. Checked by tests/unit/client/scene_test.cc.
absl::Status write_slicer_scene(const std::filesystem::path& file, const SkinMotion& motion,
                                const std::optional<Landmarks>& landmarks);

}  // namespace lipofill::client
