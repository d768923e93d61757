#include "core/solid/geometric_stiffness.h"

namespace lipofill::solid {
namespace {

/// Jacobi's method converges in three or four sweeps, the last of them quadratically.
constexpr int kMaxSweeps = 8;
/// Squares of the entries off the diagonal that are round-off, relative to the square of the
/// matrix.
constexpr double kOffDiagonal = 1e-32;
constexpr double kTiny = 1e-300;

/// Index of the entry (i, j) among (00, 11, 22, 01, 12, 20).
constexpr int kEntry[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/// Turns the plane (p, q) so that A_pq vanishes; r is the third direction, V collects the
/// rotations.
LIPOFILL_INLINE void turn_plane(int p, int q, int r, Lanes (&A)[6], Lanes (&V)[3][3]) {
  Lanes& off = A[kEntry[p][q]];
  const Lanes difference = A[q] - A[p];
  const Lanes magnitude = difference < 0.0 ? -difference : difference;
  const Lanes length = square_root(multiply_add(difference, difference, 4.0 * off * off));
  const Lanes ratio = 2.0 * off / (magnitude + length + kTiny);
  const Lanes tangent = difference < 0.0 ? -ratio : ratio;
  const Lanes cosine = 1.0 / square_root(multiply_add(tangent, tangent, fill_lanes(1.0)));
  const Lanes sine = tangent * cosine;
  A[p] = A[p] - tangent * off;
  A[q] = multiply_add(tangent, off, A[q]);
  off = Lanes{};
  const Lanes a_rp = A[kEntry[r][p]];
  const Lanes a_rq = A[kEntry[r][q]];
  A[kEntry[r][p]] = cosine * a_rp - sine * a_rq;
  A[kEntry[r][q]] = multiply_add(sine, a_rp, cosine * a_rq);
  for (auto& row : V) {
    const Lanes v_p = row[p];
    row[p] = cosine * v_p - sine * row[q];
    row[q] = multiply_add(sine, v_p, cosine * row[q]);
  }
}

/// Leaves the eigenvalues on A's diagonal and the eigenvectors in the columns of V.
void diagonalise(Lanes (&A)[6], Lanes (&V)[3][3]) {
  Lanes size{};
  for (int k = 0; k < 6; ++k) size = multiply_add((k < 3 ? 1.0 : 2.0) * A[k], A[k], size);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) V[i][j] = fill_lanes(i == j ? 1.0 : 0.0);
  }
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    const Lanes off = A[3] * A[3] + A[4] * A[4] + A[5] * A[5];
    if (!any(off > kOffDiagonal * size)) break;
    turn_plane(0, 1, 2, A, V);
    turn_plane(1, 2, 0, A, V);
    turn_plane(2, 0, 1, A, V);
  }
}

/// Puts the matrix of those eigenvalues on A's diagonal that are positive in place of A.
void compose_positive_part(const Lanes (&V)[3][3], Lanes (&A)[6]) {
  Lanes positive[3];
  for (int k = 0; k < 3; ++k) positive[k] = A[k] > 0.0 ? A[k] : Lanes{};
  for (int k = 0; k < 6; ++k) {
    const int i = k % 3;
    const int j = k < 3 ? i : (i + 1) % 3;
    A[k] = multiply_add(V[i][0] * positive[0], V[j][0],
                        multiply_add(V[i][1] * positive[1], V[j][1], V[i][2] * positive[2] * V[j][2]));
  }
}

/// Voigt entries of Vol S.
LIPOFILL_INLINE void compute_stress(const ElementBatch& batch, const Lanes& modulus, const LaneMatrix3& F,
                                    Lanes (&S)[6]) {
  for (int k = 0; k < 6; ++k) {
    const int i = k % 3;
    const int j = k < 3 ? i : (i + 1) % 3;
    const Lanes product = multiply_add(F.m[2][i], F.m[2][j], multiply_add(F.m[1][i], F.m[1][j], F.m[0][i] * F.m[0][j]));
    S[k] = k < 3 ? 0.5 * (product - 1.0) : 0.5 * product;
  }
  const Lanes pressure = modulus * batch.lambda * (S[0] + S[1] + S[2]);
  const Lanes twice_mu = 2.0 * modulus * batch.mu;
  for (int k = 0; k < 6; ++k) {
    S[k] = twice_mu * S[k];
    if (k < 3) S[k] += pressure;
  }
}

/// J S J^T with J = J_0^-1/8: the stress between the derivatives along the local coordinates.
LIPOFILL_INLINE void pull_back(const ElementBatch& batch, const Lanes (&S)[6], Lanes (&M)[3][3]) {
  const auto& J = batch.inverse_jacobian;
  Lanes JS[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      JS[i][j] =
          multiply_add(J[i][2], S[kEntry[2][j]], multiply_add(J[i][1], S[kEntry[1][j]], J[i][0] * S[kEntry[0][j]]));
    }
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      M[i][j] = multiply_add(JS[i][2], J[j][2], multiply_add(JS[i][1], J[j][1], JS[i][0] * J[j][0]));
    }
  }
}

/// sum of values[k], negative where bit k of the node's binary index is not set.
LIPOFILL_INLINE Lanes sum_by_side(int node, const Lanes& v0, const Lanes& v1, const Lanes& v2) {
  Lanes sum = (node & 1) ? v0 : -v0;
  sum = (node & 2) ? sum + v1 : sum - v1;
  return (node & 4) ? sum + v2 : sum - v2;
}

}  // namespace

void take_positive_part(Lanes (&symmetric)[6]) {
  Lanes V[3][3];
  diagonalise(symmetric, V);
  compose_positive_part(V, symmetric);
}

Lanes take_tension(Lanes (&stress)[6]) {
  Lanes V[3][3];
  diagonalise(stress, V);
  Lanes least = stress[0], largest = stress[0];
  for (int k = 1; k < 3; ++k) {
    least = stress[k] < least ? stress[k] : least;
    largest = stress[k] > largest ? stress[k] : largest;
  }
  const Lanes share = least > 0.0 ? least : (largest < 0.0 ? largest : Lanes{});
  for (int k = 0; k < 3; ++k) stress[k] -= share;
  compose_positive_part(V, stress);
  return share;
}

void compute_geometric_stiffness(const ElementBatch& batch, const Lanes& modulus, const LaneMatrix3& gradient,
                                 Lanes (&numbers)[kNodePairs]) {
  Lanes S[6];
  compute_stress(batch, modulus, gradient, S);
  take_positive_part(S);
  Lanes M[3][3];
  pull_back(batch, S, M);
#pragma GCC unroll 8
  for (int b = 0; b < 8; ++b) {
    Lanes by_b[3];
    for (int i = 0; i < 3; ++i) by_b[i] = sum_by_side(b, M[i][0], M[i][1], M[i][2]);
#pragma GCC unroll 8
    for (int a = b; a < 8; ++a) numbers[node_pair(a, b)] = sum_by_side(a, by_b[0], by_b[1], by_b[2]);
  }
}

}  // namespace lipofill::solid
