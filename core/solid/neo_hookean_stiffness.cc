#include "core/solid/geometric_stiffness.h"
#include "core/solid/hex_lanes.h"
#include "core/solid/neo_hookean_batch.h"
#include "core/solid/neo_hookean_modes.h"

namespace lipofill::solid {
namespace {

using Point = Vector3<Lanes>;

constexpr double kThird = 1.0 / 3.0;
constexpr double kNinth = 1.0 / 9.0;
constexpr int kModes = 8;

/// A block of two modes or nodes: nine numbers, and that of I which tension adds.
struct Block {
  Lanes m[3][3];
  Lanes geometric;
};

struct Components {
  Lanes c[3];
  LIPOFILL_INLINE explicit Components(const Point& v) : c{v.x, v.y, v.z} {}
};

/// K += c u v^T.
LIPOFILL_INLINE void add_product(const Lanes& c, const Point& u, const Point& v, Block& K) {
  const Components left(c * u), right(v);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) K.m[i][j] = multiply_add(left.c[i], right.c[j], K.m[i][j]);
  }
}

LIPOFILL_INLINE void add_identity(const Lanes& c, Block& K) {
  for (int i = 0; i < 3; ++i) K.m[i][i] += c;
}

/// Second slope, u by v, of mu |sym(u (x) p + v (x) q)|^2 + lambda/2 (u . p + v . q)^2.
LIPOFILL_INLINE void add_strain_product(const Moduli& moduli, const Point& p, const Point& q, Block& K) {
  add_identity(moduli.mu * dot(p, q), K);
  add_product(moduli.mu, q, p, K);
  add_product(moduli.lambda, p, q, K);
}

/// The same for u and v in the plane that is normal to n (`inverse`: 1/n^2).
LIPOFILL_INLINE void add_plane_product(const Moduli& moduli, const Point& p, const Point& q, const Point& n,
                                       const Lanes& inverse, Block& K) {
  const Point in_p = multiply_add(-inverse * dot(p, n), n, p);
  const Point in_q = multiply_add(-inverse * dot(q, n), n, q);
  add_strain_product(moduli, in_p, in_q, K);
  add_product(-moduli.mu * inverse * dot(in_p, in_q), n, n, K);
}

/// Second slopes of neo_hookean_modes.h's add_plane_stress by the modes u and v; K[2 i + j]: mode i
/// by mode j.
LIPOFILL_INLINE void add_plane_stress_tangent(const Moduli& moduli, const StrainPair& of, Block& uu, Block& uv,
                                              Block& vu, Block& vv) {
  const Lanes inverse = 1.0 / dot(of.normal, of.normal);
  add_plane_product(moduli, of.p, of.p, of.normal, inverse, uu);
  add_plane_product(moduli, of.p, of.q, of.normal, inverse, uv);
  add_plane_product(moduli, of.q, of.p, of.normal, inverse, vu);
  add_plane_product(moduli, of.q, of.q, of.normal, inverse, vv);
}

/// The second slope of |e|^2 and tr(e)^2 without what lies along n: e_nn = (u . n)(p . n)/n^2 + ...
LIPOFILL_INLINE void add_normal_free_product(const Moduli& moduli, const Point& p, const Point& q, const Point& n,
                                             const Lanes& inverse, Block& K) {
  const Lanes p_n = inverse * dot(p, n);
  const Lanes q_n = inverse * dot(q, n);
  const Point in_p = multiply_add(-p_n, n, p);
  const Point in_q = multiply_add(-q_n, n, q);
  add_identity(moduli.mu * dot(p, q), K);
  add_product(moduli.mu, q, p, K);
  add_product(-2.0 * moduli.mu * p_n * q_n, n, n, K);
  add_product(moduli.lambda, in_p, in_q, K);
}

LIPOFILL_INLINE void add_normal_stress_free_tangent(const Moduli& moduli, const StrainPair& of, Block& uu, Block& uv,
                                                    Block& vu, Block& vv) {
  const Lanes inverse = 1.0 / dot(of.normal, of.normal);
  add_normal_free_product(moduli, of.p, of.p, of.normal, inverse, uu);
  add_normal_free_product(moduli, of.p, of.q, of.normal, inverse, uv);
  add_normal_free_product(moduli, of.q, of.p, of.normal, inverse, vu);
  add_normal_free_product(moduli, of.q, of.q, of.normal, inverse, vv);
}

/// Second slopes of W_h by the hourglass modes, the dual base held.
LIPOFILL_INLINE void compute_hourglass_tangent(bool is_stacked, const NeoHookeanPose& pose, Block (&K)[4][4]) {
  const Point(&g)[3] = pose.dual;
  const Moduli moduli{kThird * pose.shear, kThird * pose.relaxed};
  const Point none{};
  add_plane_stress_tangent(moduli, {none, g[1], none, g[2], g[0]}, K[0][0], K[0][1], K[1][0], K[1][1]);
  add_plane_stress_tangent(moduli, {none, g[0], none, g[2], g[1]}, K[0][0], K[0][2], K[2][0], K[2][2]);
  const StrainPair along_zeta{none, g[0], none, g[1], g[2]};
  if (is_stacked) {
    add_plane_stress_tangent(moduli, along_zeta, K[1][1], K[1][2], K[2][1], K[2][2]);
  } else {
    add_normal_stress_free_tangent(moduli, along_zeta, K[1][1], K[1][2], K[2][1], K[2][2]);
  }
  const Moduli of_warping{kNinth * pose.shear, kNinth * pose.relaxed};
  for (int i = 0; i < 2 || (is_stacked && i < 3); ++i) add_strain_product(of_warping, g[i], g[i], K[3][3]);
  if (!is_stacked) add_product(2.0 * of_warping.mu + of_warping.lambda, g[2], g[2], K[3][3]);
}

/// w_k = s_k - sum_m (B_m . S_k) s_m: what a mode m adds to w_k.
LIPOFILL_INLINE Lanes share_in_hourglass(const NeoHookeanBatch& batch, int k, int m) {
  const Lanes own = fill_lanes(m == kHourglassModes[k] ? 1.0 : 0.0);
  if (m == 7) return own;
  const auto& B = batch.gradient[m - 1];
  const auto& S = batch.rest_hourglass[k];
  return own - multiply_add(B[2], S[2], multiply_add(B[1], S[1], B[0] * S[0]));
}

LIPOFILL_INLINE void add_scaled(const Lanes& c, const Block& of, Block& K) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) K.m[i][j] = multiply_add(c, of.m[i][j], K.m[i][j]);
  }
}

void add_hourglass_tangent(const NeoHookeanBatch& batch, const NeoHookeanPose& pose, Block (&K)[kModes][kModes]) {
  Block of_hourglass[4][4]{};
  compute_hourglass_tangent(batch.is_stacked, pose, of_hourglass);
  for (int n = 1; n < kModes; ++n) {
    Block column[4]{};
    for (int k = 0; k < 4; ++k) {
      for (int l = 0; l < 4; ++l) add_scaled(share_in_hourglass(batch, l, n), of_hourglass[k][l], column[k]);
    }
    for (int m = 1; m < kModes; ++m) {
      for (int k = 0; k < 4; ++k) add_scaled(share_in_hourglass(batch, k, m), column[k], K[m][n]);
    }
  }
}

/// V tau, entries as SymmetricTensor's.
LIPOFILL_INLINE void compute_stress(const NeoHookeanPose& pose, Lanes (&tau)[6]) {
  const auto& F = pose.gradient.m;
  for (int k = 0; k < 6; ++k) {
    const int i = k % 3;
    const int j = k < 3 ? i : (i + 1) % 3;
    const Lanes product = multiply_add(F[i][0], F[j][0], multiply_add(F[i][1], F[j][1], F[i][2] * F[j][2]));
    tau[k] = pose.shear * pose.isochoric * product;
  }
  const Lanes pressure = pose.bulk * (1.0 + pose.volume_strain) * pose.volume_strain;
  const Lanes spherical = pressure - kThird * (tau[0] + tau[1] + tau[2]);
  for (int k = 0; k < 3; ++k) tau[k] += spherical;
}

void add_homogeneous_tangent(const NeoHookeanBatch& batch, const NeoHookeanPose& pose, Block (&K)[kModes][kModes]) {
  SymmetricTensor tau;
  compute_stress(pose, tau.m);
  // tau = mu J^-2/3 F F^T - (mu' - c) I
  const Lanes mean = kThird * (tau.m[0] + tau.m[1] + tau.m[2]);
  Lanes square{};
  for (const auto& row : pose.gradient.m) {
    for (const Lanes& entry : row) square = multiply_add(entry, entry, square);
  }
  const Lanes own = kThird * pose.shear * pose.isochoric * square - mean;
  const Lanes mu = own + take_tension(tau.m);
  const Moduli moduli{mu, -2.0 * kThird * mu};
  const Lanes bulk = pose.bulk * batch.inverse_volume * batch.inverse_volume;
  Point gradient[7], carried[7];
  for (int m = 1; m < 7; ++m) {
    const auto& B = batch.gradient[m - 1];
    const auto row = [&](int i) {
      const auto& E = pose.inverse.m[i];
      return multiply_add(E[2], B[2], multiply_add(E[1], B[1], E[0] * B[0]));
    };
    gradient[m] = {row(0), row(1), row(2)};
    carried[m] = multiply(tau, gradient[m]);
  }
  for (int m = 1; m < 7; ++m) {
    for (int n = 1; n < 7; ++n) {
      add_strain_product(moduli, gradient[m], gradient[n], K[m][n]);
      add_product(bulk, pose.volume[m], pose.volume[n], K[m][n]);
      K[m][n].geometric = dot(gradient[m], carried[n]);
    }
  }
}

LIPOFILL_INLINE void combine(Block& even, Block& odd) {
  const auto butterfly = [](Lanes& e, Lanes& o) {
    const Lanes sum = e + o;
    e = e - o;
    o = sum;
  };
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) butterfly(even.m[i][j], odd.m[i][j]);
  }
  butterfly(even.geometric, odd.geometric);
}

/// H^T K H in place of K, H the basis of the modes.
void transform_to_nodes(Block (&K)[kModes][kModes]) {
  for (const int bit : kLinearModes) {
    for (int b = 0; b < kModes; ++b) {
      if (b & bit) continue;
      for (int n = 0; n < kModes; ++n) combine(K[b][n], K[b | bit][n]);
    }
  }
  for (const int bit : kLinearModes) {
    for (int b = 0; b < kModes; ++b) {
      if (b & bit) continue;
      for (int m = 0; m < kModes; ++m) combine(K[m][b], K[m][b | bit]);
    }
  }
}

}  // namespace

void add_neo_hookean_stiffness(const NeoHookeanBatch& batch, const NeoHookeanPose& pose, double* blocks) {
  Block K[kModes][kModes]{};
  add_homogeneous_tangent(batch, pose, K);
  add_hourglass_tangent(batch, pose, K);
  transform_to_nodes(K);
  for (int a = 0; a < kModes; ++a) {
    for (int b = 0; b <= a; ++b) {
      const int pair = node_pair(a, b);
      scatter_block(K[a][b].m, batch.is_transposed[pair], K[a][b].geometric, batch.block[pair], blocks);
    }
  }
}

}  // namespace lipofill::solid
