#include "core/solid/neo_hookean_batch.h"

#include "core/solid/hex_lanes.h"
#include "core/solid/neo_hookean_modes.h"

namespace lipofill::solid {
namespace {

using Point = Vector3<Lanes>;

constexpr double kThird = 1.0 / 3.0;
constexpr double kNinth = 1.0 / 9.0;
/// Newton's iteration on the cube root squares the error, so that a residual below this leaves
/// round-off.
constexpr double kRootTolerance = 1e-8;
constexpr int kMaxRootIterations = 40;

/// J^-1/3 of J > 0 by Newton's iteration y <- y + y (1 - J y^3)/3; it converges from any y with J
/// y^3 < 4.
LIPOFILL_INLINE Lanes compute_inverse_cube_root(const Lanes& J) {
  Lanes y = 3.0 / (2.0 + J);
  for (int k = 0; k < kMaxRootIterations; ++k) {
    const Lanes residual = 1.0 - J * y * y * y;
    y = multiply_add(kThird * residual, y, y);
    if (!any((residual > kRootTolerance) | (residual < -kRootTolerance))) break;
  }
  return y;
}

/// J^-2/3 and its slope; below kLeastRatio the parabola that touches it there.
struct Isochoric {
  Lanes value, slope;
};

LIPOFILL_INLINE Isochoric evaluate_isochoric(const Lanes& J, const Lanes& least_J) {
  const Lanes root = compute_inverse_cube_root(least_J);
  const Lanes value = root * root;
  const Lanes slope = -2.0 * kThird * value / least_J;
  const Lanes curvature = -5.0 * kThird * slope / least_J;
  const Lanes d = J - least_J;
  return {multiply_add(multiply_add(0.5 * curvature, d, slope), d, value), multiply_add(curvature, d, slope)};
}

LIPOFILL_INLINE void compute_gradient(const NeoHookeanBatch& batch, const Point (&s)[8], LaneMatrix3& F) {
  F = LaneMatrix3{};
  for (int k = 1; k < 7; ++k) {
    for (int j = 0; j < 3; ++j) {
      const Lanes B = batch.gradient[k - 1][j];
      F.m[0][j] = multiply_add(s[k].x, B, F.m[0][j]);
      F.m[1][j] = multiply_add(s[k].y, B, F.m[1][j]);
      F.m[2][j] = multiply_add(s[k].z, B, F.m[2][j]);
    }
  }
}

/// A v and A^T v.
LIPOFILL_INLINE Point multiply(const LaneMatrix3& A, const Point& v) {
  const auto row = [&](int i) { return multiply_add(A.m[i][2], v.z, multiply_add(A.m[i][1], v.y, A.m[i][0] * v.x)); };
  return {row(0), row(1), row(2)};
}
LIPOFILL_INLINE Point multiply_transposed(const LaneMatrix3& A, const Point& v) {
  const auto row = [&](int i) { return multiply_add(A.m[2][i], v.z, multiply_add(A.m[1][i], v.y, A.m[0][i] * v.x)); };
  return {row(0), row(1), row(2)};
}
LIPOFILL_INLINE Point to_point(const Lanes (&v)[3]) {
  return {v[0], v[1], v[2]};
}

/// A += u v^T.
LIPOFILL_INLINE void add_product(const Point& u, const Point& v, LaneMatrix3& A) {
  const Lanes left[3] = {u.x, u.y, u.z};
  for (int i = 0; i < 3; ++i) {
    A.m[i][0] = multiply_add(left[i], v.x, A.m[i][0]);
    A.m[i][1] = multiply_add(left[i], v.y, A.m[i][1]);
    A.m[i][2] = multiply_add(left[i], v.z, A.m[i][2]);
  }
}

/// Adds the law's share of the mean gradient to the energy and to P = dW/dF.
LIPOFILL_INLINE void add_homogeneous(const LaneMatrix3& C, const Lanes& least_J, NeoHookeanPose& pose, LaneMatrix3& P) {
  const LaneMatrix3& F = pose.gradient;
  Lanes square{};
  for (const auto& row : F.m) {
    for (const Lanes& entry : row) square = multiply_add(entry, entry, square);
  }
  const Isochoric isochoric = evaluate_isochoric(pose.volume_ratio, least_J);
  pose.isochoric = isochoric.value;
  pose.energy += 0.5 * pose.shear * (isochoric.value * square - 3.0);
  const Lanes along_F = pose.shear * isochoric.value;
  const Lanes along_C = 0.5 * pose.shear * square * isochoric.slope;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) P.m[i][j] = multiply_add(along_F, F.m[i][j], along_C * C.m[i][j]);
  }
}

/// Slopes of W_h by the hourglass modes w_3, w_5, w_6, w_7 and by the dual base.
struct HourglassSlopes {
  Point by_mode[4];
  Point by_dual[3];
};

LIPOFILL_INLINE Lanes compute_hourglass(bool is_stacked, const NeoHookeanPose& pose, const Point (&w)[4],
                                        HourglassSlopes& slopes) {
  const Point(&g)[3] = pose.dual;
  const Moduli moduli{kThird * pose.shear, kThird * pose.relaxed};
  Point(&f)[4] = slopes.by_mode;
  Point(&r)[3] = slopes.by_dual;
  slopes = HourglassSlopes{};
  Lanes energy = add_plane_stress(moduli, {w[0], g[1], w[1], g[2], g[0]}, {f[0], r[1], f[1], r[2], r[0]});
  energy += add_plane_stress(moduli, {w[0], g[0], w[2], g[2], g[1]}, {f[0], r[0], f[2], r[2], r[1]});
  const StrainPair along_zeta{w[1], g[0], w[2], g[1], g[2]};
  const StrainPairSlopes along_zeta_slopes{f[1], r[0], f[2], r[1], r[2]};
  energy += is_stacked ? add_plane_stress(moduli, along_zeta, along_zeta_slopes)
                       : add_normal_stress_free(moduli, along_zeta, along_zeta_slopes);
  const Moduli of_warping{kNinth * pose.shear, kNinth * pose.relaxed};
  energy += add_warping(of_warping, w[3], g[0], f[3], r[0]);
  energy += add_warping(of_warping, w[3], g[1], f[3], r[1]);
  energy += is_stacked ? add_warping(of_warping, w[3], g[2], f[3], r[2])
                       : add_normal_warping(of_warping, w[3], g[2], f[3], r[2]);
  return energy;
}

/// Adds W_h to energy and P, and its forces to those of the modes.
LIPOFILL_INLINE void add_hourglass(const NeoHookeanBatch& batch, const Point (&s)[8], NeoHookeanPose& pose,
                                   LaneMatrix3& P, Point (&f)[8]) {
  Point rest[4], w[4];
  for (int k = 0; k < 4; ++k) {
    rest[k] = to_point(batch.rest_hourglass[k]);
    w[k] = s[kHourglassModes[k]] - multiply(pose.gradient, rest[k]);
  }
  for (int i = 0; i < 3; ++i) pose.dual[i] = multiply(pose.inverse, to_point(batch.dual[i]));
  HourglassSlopes slopes;
  pose.energy += compute_hourglass(batch.is_stacked, pose, w, slopes);
  for (int k = 0; k < 4; ++k) {
    f[kHourglassModes[k]] = f[kHourglassModes[k]] + slopes.by_mode[k];
    add_product(fill_lanes(-1.0) * slopes.by_mode[k], rest[k], P);
  }
  // dg^i = -F^-T dF^T g^i
  for (int i = 0; i < 3; ++i) {
    const Point pulled = multiply_transposed(pose.inverse, slopes.by_dual[i]);
    add_product(fill_lanes(-1.0) * pose.dual[i], pulled, P);
  }
}

}  // namespace

void add_neo_hookean_forces(const NeoHookeanBatch& batch, const Lanes& modulus, const double* x, NeoHookeanPose& pose,
                            double* force) {
  pose.shear = modulus * batch.shear;
  pose.bulk = modulus * batch.bulk;
  pose.relaxed = modulus * batch.relaxed;
  Point s[8];
  gather_nodes(batch.nodes, x, s);
  pose.least_corner = find_least_corner(s);
  transform_to_modes(s);
  compute_gradient(batch, s, pose.gradient);
  LaneMatrix3 C;
  compute_cofactors(pose.gradient, C);
  const Lanes J = pose.volume_ratio = compute_determinant(pose.gradient, C);
  const Lanes least_J = J < NeoHookeanBatch::kLeastRatio ? fill_lanes(NeoHookeanBatch::kLeastRatio) : J;
  const Lanes inverse_J = 1.0 / least_J;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.inverse.m[i][j] = inverse_J * C.m[i][j];
  }
  pose.volume_strain = multiply_add(batch.inverse_volume, compute_volume(s, pose.volume), fill_lanes(-1.0));
  const Lanes tension = pose.bulk * pose.volume_strain;
  pose.energy = 0.5 * tension * pose.volume_strain;
  const Lanes by_volume = tension * batch.inverse_volume;
  Point f[8];
  f[0] = f[7] = Point{};
  for (int k = 1; k < 7; ++k) f[k] = by_volume * pose.volume[k];
  LaneMatrix3 P;
  add_homogeneous(C, least_J, pose, P);
  add_hourglass(batch, s, pose, P, f);
  for (int k = 1; k < 7; ++k) f[k] = f[k] + multiply(P, to_point(batch.gradient[k - 1]));
  transform_to_nodes(f);
  scatter_nodes(batch.nodes, f, force);
}

}  // namespace lipofill::solid
