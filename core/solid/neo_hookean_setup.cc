// The constant numbers of neo-Hookean batches, from an element's rest shape and material.

#include <Eigen/LU>

#include "core/solid/hex_lanes.h"
#include "core/solid/inversion_barrier.h"
#include "core/solid/neo_hookean_batch.h"
#include "core/solid/neo_hookean_modes.h"

namespace lipofill::solid {
namespace {

using Point = Vector3<double>;

Point to_point(const Eigen::Vector3d& v) {
  return {v[0], v[1], v[2]};
}

void set(const Point& v, int lane, Lanes (&to)[3]) {
  to[0][lane] = v.x;
  to[1][lane] = v.y;
  to[2][lane] = v.z;
}

}  // namespace

void NeoHookeanBatch::set_lane(int lane, const std::array<int, 8>& hexahedron, const HexNodes& rest,
                               double poisson_ratio) {
  Point s[8];
  for (int b = 0; b < 8; ++b) {
    nodes[b][lane] = hexahedron[kCornerOfBinary[b]];
    s[b] = to_point(rest.col(kCornerOfBinary[b]) - rest.col(0));
  }
  transform_to_modes(s);
  Point slope[8];
  const double inverse = 1.0 / compute_volume(s, slope);
  inverse_volume[lane] = inverse;
  for (int k = 1; k < 7; ++k) set(inverse * slope[k], lane, gradient[k - 1]);
  for (int k = 0; k < 4; ++k) set(s[kHourglassModes[k]], lane, rest_hourglass[k]);
  const Eigen::Matrix3d to_dual = 0.125 * compute_jacobian(rest, LocalPoint::Zero()).inverse();
  for (int i = 0; i < 3; ++i) set(to_point(to_dual.row(i)), lane, dual[i]);
  const double volume = 1.0 / (64.0 * inverse);
  const double mu = volume / (2.0 * (1.0 + poisson_ratio));
  const double lambda = 2.0 * mu * poisson_ratio / (1.0 - 2.0 * poisson_ratio);
  shear[lane] = mu;
  bulk[lane] = lambda + 2.0 * mu / 3.0;
  relaxed[lane] = 2.0 * lambda * mu / (lambda + 2.0 * mu);
  squeezed_corner[lane] = InversionBarrier::kThreshold * InversionBarrier::find_largest_corner(rest);
}

void NeoHookeanBatch::silence_lane(int lane) {
  shear[lane] = bulk[lane] = relaxed[lane] = 0.0;
}

}  // namespace lipofill::solid
