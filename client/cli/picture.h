#pragma once

#include <filesystem>

#include "absl/status/status.h"

namespace lipofill::client {

enum class Picture { kResult, kDistance, kScan, kDeficit, kReport, kThickness, kFilm };

/// The folder of a scan to be drawn holds this file.
inline constexpr char kScanToDraw[] = "scan.vtp";
inline constexpr char kTextToDraw[] = "scan.txt";

/// Draws the picture of a folder of results ("picture.png", or "distance.png" from its
/// distance.vtp; a map of thickness from what write_thickness() wrote; a scan from its kScanToDraw
/// and kTextToDraw; all pictures of a report, or frames of a film, into the folder) in a process of
/// its own: on the X server that $DISPLAY names, or else under xvfb-run. FAILED_PRECONDITION,
/// saying what to install, where there is neither. Checked by tests/integration/cli/.
absl::Status draw_picture(const std::filesystem::path& folder, Picture picture, const std::filesystem::path& png);

}  // namespace lipofill::client
