#include "core/solid/element_batch.h"

#include <Eigen/LU>

#include "core/solid/rotation.h"

// The arithmetic below is inlined into one function a processor family, so that its lanes fill that family's registers.
#define LIPOFILL_INLINE inline __attribute__((always_inline))

namespace lipofill::solid {
namespace {

// Newton's iteration squares the error, so a last change below this leaves round-off.
constexpr double kRotationTolerance = 1e-9;
constexpr int kMaxRotationIterations = 12;
// Below this share of its edges' product the determinant says little about the inverse.
constexpr double kMinRelativeDeterminant = 1e-3;

LIPOFILL_INLINE void cofactors(const LaneMatrix3& A, LaneMatrix3& C) {
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3;
    const int i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3;
      const int j2 = (j + 2) % 3;
      C.m[i][j] = A.m[i1][j1] * A.m[i2][j2] - A.m[i1][j2] * A.m[i2][j1];
    }
  }
}

LIPOFILL_INLINE void gather(const ElementBatch& batch, const Eigen::Matrix3Xd& x, Lanes (&relative)[8][3]) {
  for (int a = 0; a < 8; ++a) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const double* const position = x.data() + 3 * batch.nodes[lane][a];
      for (int c = 0; c < 3; ++c) relative[a][c][lane] = position[c];
    }
  }
  for (int c = 0; c < 3; ++c) {
    Lanes mean = relative[0][c];
    for (int a = 1; a < 8; ++a) mean += relative[a][c];
    mean *= 0.125;
    for (int a = 0; a < 8; ++a) relative[a][c] -= mean;
  }
}

/// F = (dx/dxi) (dX/dxi)^-1 at the centre, where dN_a/dxi_j = +-1/8.
LIPOFILL_INLINE void deformation_gradient(const ElementBatch& batch, const Lanes (&x)[8][3], LaneMatrix3& F) {
  LaneMatrix3 J;
  for (int c = 0; c < 3; ++c) {
    J.m[c][0] = 0.125 * (x[1][c] + x[2][c] + x[5][c] + x[6][c] - x[0][c] - x[3][c] - x[4][c] - x[7][c]);
    J.m[c][1] = 0.125 * (x[2][c] + x[3][c] + x[6][c] + x[7][c] - x[0][c] - x[1][c] - x[4][c] - x[5][c]);
    J.m[c][2] = 0.125 * (x[4][c] + x[5][c] + x[6][c] + x[7][c] - x[0][c] - x[1][c] - x[2][c] - x[3][c]);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      F.m[i][j] = J.m[i][0] * batch.inverse_jacobian.m[0][j] + J.m[i][1] * batch.inverse_jacobian.m[1][j] +
                  J.m[i][2] * batch.inverse_jacobian.m[2][j];
    }
  }
}

LIPOFILL_INLINE void determinant(const LaneMatrix3& A, const LaneMatrix3& cofactor, Lanes& det) {
  det = A.m[0][0] * cofactor.m[0][0] + A.m[0][1] * cofactor.m[0][1] + A.m[0][2] * cofactor.m[0][2];
}

/// One Newton step on R; `change` is the largest change of an entry.
LIPOFILL_INLINE void newton_step(LaneMatrix3& R, Lanes& change) {
  LaneMatrix3 C;
  Lanes det;
  cofactors(R, C);
  determinant(R, C, det);
  const Lanes half_inverse = 0.5 / det;
  change = Lanes{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Lanes next = 0.5 * R.m[i][j] + half_inverse * C.m[i][j];
      const Lanes difference = next - R.m[i][j];
      const Lanes magnitude = difference < 0.0 ? -difference : difference;
      change = magnitude > change ? magnitude : change;
      R.m[i][j] = next;
    }
  }
}

LIPOFILL_INLINE bool all_below(const Lanes& value, double bound) {
  bool below = true;
  for (int lane = 0; lane < kLanes; ++lane) below = below && value[lane] < bound;
  return below;
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

LIPOFILL_INLINE void nearest_rotation(const LaneMatrix3& F, const Lanes& det, LaneMatrix3& R) {
  R = F;
  Lanes change;
  for (int k = 0; k < kMaxRotationIterations; ++k) {
    newton_step(R, change);
    if (all_below(change, kRotationTolerance)) break;
  }
  Lanes size = {};
  for (int i = 0; i < 3; ++i) size += F.m[i][0] * F.m[i][0] + F.m[i][1] * F.m[i][1] + F.m[i][2] * F.m[i][2];
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool plain = det[lane] * det[lane] >
                       kMinRelativeDeterminant * kMinRelativeDeterminant * size[lane] * size[lane] * size[lane];
    const bool converged = change[lane] < kRotationTolerance;
    if (!(plain && converged && det[lane] > 0.0)) rotate_lane_robustly(F, lane, R);
  }
}

/// d = R^T x - X.
LIPOFILL_INLINE void local_displacement(const ElementBatch& batch, const Lanes (&x)[8][3], const LaneMatrix3& R,
                                        Lanes (&d)[8][3]) {
  for (int a = 0; a < 8; ++a) {
    for (int c = 0; c < 3; ++c) {
      d[a][c] = R.m[0][c] * x[a][0] + R.m[1][c] * x[a][1] + R.m[2][c] * x[a][2] - batch.rest[a][c];
    }
  }
}

/// f = K d from the lower blocks of K.
LIPOFILL_INLINE void multiply(const ElementBatch& batch, const Lanes (&d)[8][3], Lanes (&f)[8][3]) {
  for (int a = 0; a < 8; ++a) {
    for (int i = 0; i < 3; ++i) f[a][i] = Lanes{};
  }
  for (int a = 0; a < 8; ++a) {
    for (int b = 0; b <= a; ++b) {
      const LaneMatrix3& K = batch.stiffness[node_pair(a, b)];
      for (int i = 0; i < 3; ++i) f[a][i] += K.m[i][0] * d[b][0] + K.m[i][1] * d[b][1] + K.m[i][2] * d[b][2];
      if (a == b) continue;
      for (int j = 0; j < 3; ++j) f[b][j] += K.m[0][j] * d[a][0] + K.m[1][j] * d[a][1] + K.m[2][j] * d[a][2];
    }
  }
}

LIPOFILL_INLINE void rotate_force(const LaneMatrix3& R, const Lanes (&local)[8][3], Lanes (&force)[8][3]) {
  for (int a = 0; a < 8; ++a) {
    for (int c = 0; c < 3; ++c) {
      force[a][c] = R.m[c][0] * local[a][0] + R.m[c][1] * local[a][1] + R.m[c][2] * local[a][2];
    }
  }
}

/// R K R^T.
LIPOFILL_INLINE void rotate_block(const LaneMatrix3& R, const LaneMatrix3& K, LaneMatrix3& rotated) {
  LaneMatrix3 RK;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) RK.m[i][j] = R.m[i][0] * K.m[0][j] + R.m[i][1] * K.m[1][j] + R.m[i][2] * K.m[2][j];
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      rotated.m[i][j] = RK.m[i][0] * R.m[j][0] + RK.m[i][1] * R.m[j][1] + RK.m[i][2] * R.m[j][2];
    }
  }
}

template <bool kWithStiffness>
LIPOFILL_INLINE void compute_batch_inline(const ElementBatch& batch, const Eigen::Matrix3Xd& x, BatchResult& result) {
  Lanes relative[8][3];
  gather(batch, x, relative);
  LaneMatrix3 F;
  deformation_gradient(batch, relative, F);
  LaneMatrix3 C;
  cofactors(F, C);
  determinant(F, C, result.volume_ratio);
  LaneMatrix3 R;
  nearest_rotation(F, result.volume_ratio, R);

  Lanes d[8][3];
  local_displacement(batch, relative, R, d);
  Lanes local_force[8][3];
  multiply(batch, d, local_force);
  result.energy = Lanes{};
  for (int a = 0; a < 8; ++a) {
    for (int c = 0; c < 3; ++c) result.energy += 0.5 * d[a][c] * local_force[a][c];
  }
  rotate_force(R, local_force, result.force);
  if (!kWithStiffness) return;
  for (int pair = 0; pair < kNodePairs; ++pair) rotate_block(R, batch.stiffness[pair], result.stiffness[pair]);
}

#if defined(__x86_64__)
template <bool kWithStiffness>
__attribute__((target("avx2"))) void compute_batch_avx2(const ElementBatch& batch, const Eigen::Matrix3Xd& x,
                                                        BatchResult& result) {
  compute_batch_inline<kWithStiffness>(batch, x, result);
}
#endif

template <bool kWithStiffness>
void compute_batch_here(const ElementBatch& batch, const Eigen::Matrix3Xd& x, BatchResult& result) {
#if defined(__x86_64__)
  static const bool has_avx2 = __builtin_cpu_supports("avx2");
  if (has_avx2) return compute_batch_avx2<kWithStiffness>(batch, x, result);
#endif
  compute_batch_inline<kWithStiffness>(batch, x, result);
}

}  // namespace

void ElementBatch::set_lane(int lane, const std::array<int, 8>& hexahedron, const HexNodes& positions,
                            const HexStiffness& K) {
  const Eigen::Matrix3d inverse = compute_jacobian(positions, LocalPoint::Zero()).inverse();
  const Eigen::Vector3d mean = positions.rowwise().mean();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) inverse_jacobian.m[i][j][lane] = inverse(i, j);
  }
  for (int a = 0; a < 8; ++a) {
    nodes[lane][a] = hexahedron[a];
    for (int c = 0; c < 3; ++c) rest[a][c][lane] = positions(c, a) - mean[c];
    for (int b = 0; b <= a; ++b) {
      LaneMatrix3& block = stiffness[node_pair(a, b)];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) block.m[i][j][lane] = K(3 * a + i, 3 * b + j);
      }
    }
  }
}

void compute_batch_portable(const ElementBatch& batch, const Eigen::Matrix3Xd& x, BatchResult& result) {
  compute_batch_inline<true>(batch, x, result);
}

void compute_batch(const ElementBatch& batch, const Eigen::Matrix3Xd& x, BatchResult& result) {
  compute_batch_here<true>(batch, x, result);
}

void compute_batch_force(const ElementBatch& batch, const Eigen::Matrix3Xd& x, BatchResult& result) {
  compute_batch_here<false>(batch, x, result);
}

}  // namespace lipofill::solid
