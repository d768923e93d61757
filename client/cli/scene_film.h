#pragma once

#include <filesystem>

#include "absl/status/status.h"
#include "client/cli/run_record.h"
#include "client/cpp/scene/skin_motion.h"

namespace lipofill::client {

/// How a film of a result is made.
struct FilmOptions {
  size_t stills = 30;   ///< of the result, at most
  double play_s = 0.0;  ///< the motion in so many seconds; 0: kUsualPlayS
};

inline constexpr double kUsualPlayS = 4.0;
inline constexpr int kFramesPerSecond = 25;
/// The result stands still for so long at the end.
inline constexpr double kStandS = 1.0;

/// Tells whether a file is to be a film: .mp4 (H.264) or .webm (VP9).
bool is_film(const std::filesystem::path& file);

/// Films the rise of the skin of a folder of results, coloured by its displacement, from one
/// camera: between two stills the skin goes in a straight line. Frames are drawn as pictures are,
/// in a process of their own, and joined by the program ffmpeg. FAILED_PRECONDITION, with what to
/// install, without ffmpeg or a screen. Checked by tests/python/test_scenes.py.
absl::Status write_film(const std::filesystem::path& result, const std::filesystem::path& out,
                        const FilmOptions& options);

/// Draws the frames of a film into a folder that write_film() has prepared; for the process that
/// draws.
absl::Status draw_film_frames(const std::filesystem::path& folder);

}  // namespace lipofill::client
