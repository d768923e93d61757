#pragma once

#include <algorithm>

namespace lipofill::anatomy {

/// S(u) = u^2 (3 - 2 u), 0 below 0 and 1 above 1: how figures of a region go over into those
/// around.
inline double smooth_step(double u) {
  const double v = std::clamp(u, 0.0, 1.0);
  return v * v * (3.0 - 2.0 * v);
}

}  // namespace lipofill::anatomy
