#pragma once

#include <array>

#include "core/geometry/face_geometry.h"

namespace lipofill::geometry {

/// Corners of the region around the left masseter and the angle of the mandible, front below, back
/// below, back above, front above: xi runs backwards, eta upwards, clear of ear and lips. The
/// sample plan jaw_angle.json uses the same.
inline std::array<SkinPoint, 4> make_jaw_angle_corners() {
  constexpr double kMm = 1e-3;
  return {LandmarkPoint{{{"gonion_left", 0.3}, {"menton", 0.3}, {"cheilion_left", 0.4}}, 11 * kMm, -14 * kMm, 5 * kMm},
          LandmarkPoint{{{"gonion_left", 1.0}}, -2 * kMm, -17 * kMm, -12 * kMm},
          LandmarkPoint{{{"zygion_left", 0.8}, {"gonion_left", 0.2}}, 2 * kMm, 1 * kMm, -10 * kMm},
          LandmarkPoint{{{"zygion_left", 0.35}, {"cheilion_left", 0.65}}, 8 * kMm, 18 * kMm, 7 * kMm}};
}

}  // namespace lipofill::geometry
