#include "core/solid/element_batch.h"

#include "core/solid/hex_lanes.h"
#include "core/solid/rotation.h"

namespace lipofill::solid {
namespace {

using Point = Vector3<Lanes>;

// Newton's iteration squares the error, so a last change below this leaves round-off.
constexpr double kRotationTolerance = 1e-8;
constexpr int kMaxRotationIterations = 12;
// Below this share of its edges' product the determinant says little about the inverse.
constexpr double kMinRelativeDeterminant = 1e-3;

LIPOFILL_INLINE void compute_gradient(const ElementBatch& batch, const Point (&modes)[8], LaneMatrix3& F) {
  const auto& J = batch.inverse_jacobian;
  const Point &s1 = modes[1], &s2 = modes[2], &s3 = modes[4];
  for (int j = 0; j < 3; ++j) {
    F.m[0][j] = multiply_add(s3.x, J[2][j], multiply_add(s2.x, J[1][j], s1.x * J[0][j]));
    F.m[1][j] = multiply_add(s3.y, J[2][j], multiply_add(s2.y, J[1][j], s1.y * J[0][j]));
    F.m[2][j] = multiply_add(s3.z, J[2][j], multiply_add(s2.z, J[1][j], s1.z * J[0][j]));
  }
}

/// Takes one Newton step on R; returns the largest change of an entry.
LIPOFILL_INLINE Lanes improve_rotation(LaneMatrix3& R) {
  LaneMatrix3 C;
  compute_cofactors(R, C);
  const Lanes half_inverse = 0.5 / compute_determinant(R, C);
  Lanes change{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Lanes next = multiply_add(half_inverse, C.m[i][j], 0.5 * R.m[i][j]);
      const Lanes difference = next - R.m[i][j];
      const Lanes magnitude = difference < 0.0 ? -difference : difference;
      change = magnitude > change ? magnitude : change;
      R.m[i][j] = next;
    }
  }
  return change;
}

/// The rotation of one lane, apart from the others; rare.
__attribute__((noinline)) void rotate_lane_robustly(const LaneMatrix3& F, int lane, LaneMatrix3& R) {
  Eigen::Matrix3d F_lane;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) F_lane(i, j) = F.m[i][j][lane];
  }
  const Eigen::Matrix3d rotation = compute_nearest_rotation(F_lane);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R.m[i][j][lane] = rotation(i, j);
  }
}

LIPOFILL_INLINE void find_rotation(const LaneMatrix3& F, const Lanes& det, LaneMatrix3& R) {
  R = F;
  Lanes change;
  for (int k = 0; k < kMaxRotationIterations; ++k) {
    change = improve_rotation(R);
    if (!any(!(change < kRotationTolerance))) break;
  }
  Lanes size{};
  for (const auto& row : F.m) {
    for (const Lanes& entry : row) size = multiply_add(entry, entry, size);
  }
  const Lanes least = kMinRelativeDeterminant * kMinRelativeDeterminant * size * size * size;
  const LaneMask is_plain = (det > 0.0) & (det * det > least) & (change < kRotationTolerance);
  if (!any(!is_plain)) return;
  for (int lane = 0; lane < kLanes; ++lane) {
    if (is_plain[lane] == 0) rotate_lane_robustly(F, lane, R);
  }
}

/// Returns (R^T v)_c.
LIPOFILL_INLINE Lanes rotate_back(const LaneMatrix3& R, int c, const Lanes& x, const Lanes& y, const Lanes& z) {
  return multiply_add(R.m[2][c], z, multiply_add(R.m[1][c], y, R.m[0][c] * x));
}

LIPOFILL_INLINE void compute_modal_coordinates(const ElementBatch& batch, const Point (&modes)[8], const LaneMatrix3& F,
                                               const LaneMatrix3& R, Lanes (&q)[18]) {
  const auto stretch = [&](int i, int j) { return rotate_back(R, i, F.m[0][j], F.m[1][j], F.m[2][j]); };
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    q[i] = stretch(i, i) - 1.0;
    q[3 + i] = stretch(i, j) + stretch(j, i);
  }
  for (int k = 0; k < 4; ++k) {
    const Point& s = modes[kHourglassModes[k]];
    for (int c = 0; c < 3; ++c) q[6 + 3 * k + c] = rotate_back(R, c, s.x, s.y, s.z) - batch.rest_hourglass[k][c];
  }
}

/// p = K_q q, block row by block row; returns q . p.
LIPOFILL_INLINE Lanes multiply(const Lanes* K, const Lanes (&q)[18], Lanes (&p)[18]) {
#pragma GCC unroll 6
  for (int row = 0; row < 6; ++row) {
    const Lanes* const u = q + 3 * row;
    Lanes own[3];
    own[0] = multiply_add(K[0], u[0], multiply_add(K[1], u[1], K[3] * u[2]));
    own[1] = multiply_add(K[1], u[0], multiply_add(K[2], u[1], K[4] * u[2]));
    own[2] = multiply_add(K[3], u[0], multiply_add(K[4], u[1], K[5] * u[2]));
    K += 6;
    for (int column = 0; column < row; ++column, K += 9) {
      const Lanes* const v = q + 3 * column;
      Lanes* const across = p + 3 * column;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          own[i] = multiply_add(K[3 * i + j], v[j], own[i]);
          across[j] = multiply_add(K[3 * i + j], u[i], across[j]);
        }
      }
    }
    for (int i = 0; i < 3; ++i) p[3 * row + i] = own[i];
  }
  Lanes product{};
  for (int i = 0; i < 18; ++i) product = multiply_add(p[i], q[i], product);
  return product;
}

/// A^T p, mode by mode and turned by R (E R where p is of 1 Pa): with M the symmetric matrix of p's
/// first six and p_k those of the hourglasses, f_j = (M - skew(sum_k p_k S_k^T)) J_0^-T e_j/8 of
/// the linear modes and f_k = p_k of the others.
LIPOFILL_INLINE void compute_modal_forces(const ElementBatch& batch, const LaneMatrix3& R, const Lanes (&p)[18],
                                          Point (&f)[8]) {
  const auto& S = batch.rest_hourglass;
  Lanes A[3][3];
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    Lanes twice_skew{};
    for (int k = 0; k < 4; ++k) {
      twice_skew = multiply_add(p[6 + 3 * k + i], S[k][j], twice_skew) - p[6 + 3 * k + j] * S[k][i];
    }
    A[i][i] = p[i];
    A[i][j] = p[3 + i] - 0.5 * twice_skew;
    A[j][i] = p[3 + i] + 0.5 * twice_skew;
  }
  const auto turn = [&](const Lanes& x, const Lanes& y, const Lanes& z) -> Point {
    const auto row = [&](int i) { return multiply_add(R.m[i][2], z, multiply_add(R.m[i][1], y, R.m[i][0] * x)); };
    return {row(0), row(1), row(2)};
  };
  f[0] = Point{};
  for (int j = 0; j < 3; ++j) {
    const Lanes(&J)[3] = batch.inverse_jacobian[j];
    const auto row = [&](int i) { return multiply_add(A[i][2], J[2], multiply_add(A[i][1], J[1], A[i][0] * J[0])); };
    f[kLinearModes[j]] = turn(row(0), row(1), row(2));
  }
  for (int k = 0; k < 4; ++k) f[kHourglassModes[k]] = turn(p[6 + 3 * k], p[7 + 3 * k], p[8 + 3 * k]);
}

/// (E R) K R^T.
LIPOFILL_INLINE void rotate_block(const LaneMatrix3& ER, const Lanes (&K)[9], const LaneMatrix3& R,
                                  Lanes (&rotated)[3][3]) {
  Lanes RK[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      RK[i][j] = multiply_add(ER.m[i][2], K[6 + j], multiply_add(ER.m[i][1], K[3 + j], ER.m[i][0] * K[j]));
    }
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      rotated[i][j] = multiply_add(RK[i][2], R.m[j][2], multiply_add(RK[i][1], R.m[j][1], RK[i][0] * R.m[j][0]));
    }
  }
}

/// A block of the batch that comes next. Stores to so many places keep the processor from seeing by
/// itself which numbers are read in order; without this the tangent takes half as long again.
LIPOFILL_INLINE void prefetch(const Lanes* block) {
  for (int k = 0; k < 9; k += 2) __builtin_prefetch(block + k);
}

}  // namespace

void add_element_forces(const ElementBatch& batch, const Lanes& modulus, const double* x, ElementPose& pose,
                        double* force) {
  Point points[8];
  gather_nodes(batch.nodes, x, points);
  pose.least_corner = find_least_corner(points);
  transform_to_modes(points);
  LaneMatrix3& F = pose.gradient;
  compute_gradient(batch, points, F);
  LaneMatrix3 C;
  compute_cofactors(F, C);
  pose.volume_ratio = compute_determinant(F, C);
  find_rotation(F, pose.volume_ratio, pose.rotation);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.stiff_rotation.m[i][j] = modulus * pose.rotation.m[i][j];
  }
  Lanes q[18], p[18];
  compute_modal_coordinates(batch, points, F, pose.rotation, q);
  pose.energy = 0.5 * modulus * multiply(batch.modal_stiffness, q, p);
  compute_modal_forces(batch, pose.stiff_rotation, p, points);
  transform_to_nodes(points);
  scatter_nodes(batch.nodes, points, force);
}

void add_element_stiffness(const StiffnessBatch& batch, const StiffnessBatch& next, const ElementPose& pose,
                           const Lanes (&geometric)[kNodePairs], double* blocks) {
  const LaneMatrix3 R = pose.rotation;
  const LaneMatrix3 ER = pose.stiff_rotation;
  const Lanes* K = batch.numbers;
  for (int a = 0; a < 8; ++a) {
    Lanes rotated[3][3];
    for (int b = 0; b < a; ++b, K += 9) {
      const int pair = node_pair(a, b);
      prefetch(next.numbers + (K - batch.numbers));
      const Lanes whole[9] = {K[0], K[1], K[2], K[3], K[4], K[5], K[6], K[7], K[8]};
      rotate_block(ER, whole, R, rotated);
      scatter_block(rotated, batch.is_transposed[pair], geometric[pair], batch.block[pair], blocks);
    }
    const Lanes full[9] = {K[0], K[1], K[3], K[1], K[2], K[4], K[3], K[4], K[5]};
    rotate_block(ER, full, R, rotated);
    scatter_block(rotated, false, geometric[node_pair(a, a)], batch.block[node_pair(a, a)], blocks);
    K += 6;
  }
}

}  // namespace lipofill::solid
