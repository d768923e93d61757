#pragma once

#include <array>
#include <optional>
#include <string>

#include "client/cpp/scene/skin_motion.h"

namespace lipofill::client {

/// The options say what a GLB shows.
struct GlbOptions {
  std::string name = {};     ///< of the plan
  bool by_pressure = false;  ///< colours are bands of pressure, else the lift
  double play_s = 0.0;       ///< the motion in so many seconds; 0: as long as it takes
  /// Colours of the points as screens show them, in place of those of lift or pressure.
  std::optional<Eigen::Matrix3Xf> colours = {};
  std::optional<std::array<double, 3>> up = {};  ///< in the frame of the scan; none: z, as in LPS
};

/// The skin as a binary glTF 2.0: the result in colours, at rest a morph target away, with the
/// motion as an animation of the weights
///
///     x(t) = x_rest + sum_k w_k(t) u_k,   w_k(t_j) = 1 for j = k, else 0, linear between
///
/// in metres, y up, as glTF wants; a node turns, scales and places it, so that the numbers within
/// are millimetres from the middle of the scan and lose nothing far from the origin. Checked by
/// tests/unit/client/scene_test.cc and, with Khronos' validator, by tests/python/test_scenes.py.
std::string glb_of(const SkinMotion& motion, const GlbOptions& options);

}  // namespace lipofill::client
