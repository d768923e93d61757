#pragma once

#include <cstdint>

#include "core/base/lanes.h"
#include "core/solid/element_batch.h"

namespace lipofill::solid {

// This is what batches of hexahedra have in common, whatever their law: how positions come from the
// nodes, how forces and blocks of stiffness get back to them, and how nodes are turned into modes.
// Nodes are in binary order.

/// Modes of the nodes that are linear along one local coordinate, and those that are products of
/// two or three.
inline constexpr int kLinearModes[3] = {1, 2, 4};
inline constexpr int kHourglassModes[4] = {3, 5, 6, 7};

/// Positions of the nodes from the first of them on: sums of far coordinates would lose digits.
LIPOFILL_INLINE void gather_nodes(const int (&places)[8][kLanes], const double* x, Vector3<Lanes> (&nodes)[8]) {
  for (int b = 0; b < 8; ++b) {
    Lanes rows[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) rows[lane] = load(x + 4 * static_cast<std::ptrdiff_t>(places[b][lane]));
    transpose(rows);
    nodes[b] = {rows[0], rows[1], rows[2]};
  }
  for (int b = 7; b >= 0; --b) nodes[b] = nodes[b] - nodes[0];
}

LIPOFILL_INLINE void scatter_nodes(const int (&places)[8][kLanes], const Vector3<Lanes> (&f)[8], double* force) {
  for (int b = 0; b < 8; ++b) {
    Lanes rows[kLanes] = {f[b].x, f[b].y, f[b].z, Lanes{}};
    transpose(rows);
    for (int lane = 0; lane < kLanes; ++lane) {
      add_to(rows[lane], force + 4 * static_cast<std::ptrdiff_t>(places[b][lane]));
    }
  }
}

/// Adds a block of two nodes column by column, `geometric` behind the first.
LIPOFILL_INLINE void scatter_block(const Lanes (&K)[3][3], bool is_transposed, const Lanes& geometric,
                                   const std::int32_t (&places)[kLanes], double* blocks) {
  for (int j = 0; j < 3; ++j) {
    Lanes rows[kLanes];
    for (int i = 0; i < 3; ++i) rows[i] = is_transposed ? K[j][i] : K[i][j];
    rows[3] = j == 0 ? geometric : Lanes{};
    transpose(rows);
    for (int lane = 0; lane < kLanes; ++lane) {
      add_to(rows[lane], blocks + 12 * static_cast<std::ptrdiff_t>(places[lane]) + 4 * j);
    }
  }
}

/// Least over the corners of the determinant of the three edges that meet there, along the local
/// coordinates.
LIPOFILL_INLINE Lanes find_least_corner(const Vector3<Lanes> (&x)[8]) {
  Vector3<Lanes> along[3][8];
  for (int k = 0; k < 3; ++k) {
    for (int b = 0; b < 8; ++b) {
      if (!(b & kLinearModes[k])) along[k][b] = along[k][b | kLinearModes[k]] = x[b | kLinearModes[k]] - x[b];
    }
  }
  Lanes least = dot(along[0][0], cross(along[1][0], along[2][0]));
  for (int b = 1; b < 8; ++b) {
    const Lanes corner = dot(along[0][b], cross(along[1][b], along[2][b]));
    least = least < corner ? least : corner;
  }
  return least;
}

/// Puts s_k = sum_b h_k(b) x_b of all modes in place of the nodes.
template <typename T>
LIPOFILL_INLINE void transform_to_modes(Vector3<T> (&x)[8]) {
  for (const int bit : kLinearModes) {
    for (int b = 0; b < 8; ++b) {
      if (b & bit) continue;
      const Vector3<T> low = x[b];
      const Vector3<T> high = x[b | bit];
      x[b] = high + low;
      x[b | bit] = high - low;
    }
  }
}

/// Puts sum_k h_k(b) f_k of all nodes in place of the modes.
template <typename T>
LIPOFILL_INLINE void transform_to_nodes(Vector3<T> (&f)[8]) {
  for (const int bit : kLinearModes) {
    for (int b = 0; b < 8; ++b) {
      if (b & bit) continue;
      const Vector3<T> even = f[b];
      const Vector3<T> odd = f[b | bit];
      f[b] = even - odd;
      f[b | bit] = even + odd;
    }
  }
}

LIPOFILL_INLINE void compute_cofactors(const LaneMatrix3& A, LaneMatrix3& C) {
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

/// `C`: the cofactors of A.
LIPOFILL_INLINE Lanes compute_determinant(const LaneMatrix3& A, const LaneMatrix3& C) {
  return multiply_add(A.m[0][2], C.m[0][2], multiply_add(A.m[0][1], C.m[0][1], A.m[0][0] * C.m[0][0]));
}

}  // namespace lipofill::solid
