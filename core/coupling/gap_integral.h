#pragma once

#include "core/base/lanes.h"

namespace lipofill::coupling {

/// A piece of the gap between two bilinear walls, T = double, or Lanes of them. Corners as those of
/// the quadrilateral it lies in: (s, t) = (0, 0), (1, 0), (1, 1), (0, 1).
template <typename T>
struct GapPiece {
  Vector3<T> middle[4];    ///< half-way between the walls [m]
  Vector3<T> distance[4];  ///< it points from the inner to the outer wall [m]
  T s[2], t[2];            ///< places of the Gauss points
  T weight[4];             ///< of the Gauss points, s fastest
};

/// Derivatives of a piece's volume [m2].
template <typename T>
struct GapGradient {
  Vector3<T> by_middle[4];
  Vector3<T> by_distance[4];
};

/// Volume of the piece,
///
///     V = int det(dX/ds, dX/dt, d) ds dt du = int [a x b + (a' x b')/12] . d ds dt,     X = middle + u d, |u| < 1/2
///
/// a, b the tangents of the middle along s and t, a', b' those of d: exact by 2 x 2 points. Where
/// both walls touch, d = 0, volume and by_middle are exactly 0. Weights of a piece that an outline
/// cuts come from geometry::fit_gauss_shares.
template <bool kWithGradient, typename T>
LIPOFILL_INLINE T integrate_piece(const GapPiece<T>& piece, GapGradient<T>* gradient) {
  using Vector = Vector3<T>;
  const auto& m = piece.middle;
  const auto& d = piece.distance;
  const Vector m_along_s[2] = {m[1] - m[0], m[2] - m[3]};  // holds at t = 0, 1
  const Vector m_along_t[2] = {m[3] - m[0], m[2] - m[1]};  // holds at s = 0, 1
  const Vector d_along_s[2] = {d[1] - d[0], d[2] - d[3]};
  const Vector d_along_t[2] = {d[3] - d[0], d[2] - d[1]};
  const T one = T{} + 1.0;
  const T twelfth = T{} + 1.0 / 12.0;
  Vector by_m_s[2]{}, by_m_t[2]{}, by_d_s[2]{}, by_d_t[2]{}, by_d[4]{};
  T volume{};
  for (int q = 0; q < 2; ++q) {
    const T& t = piece.t[q];
    const Vector a = multiply_add(t, m_along_s[1] - m_along_s[0], m_along_s[0]);
    const Vector a_of_d = multiply_add(t, d_along_s[1] - d_along_s[0], d_along_s[0]);
    const Vector d_left = multiply_add(t, d_along_t[0], d[0]);
    for (int p = 0; p < 2; ++p) {
      const T& s = piece.s[p];
      const T& weight = piece.weight[2 * q + p];
      const Vector b = multiply_add(s, m_along_t[1] - m_along_t[0], m_along_t[0]);
      const Vector b_of_d = multiply_add(s, d_along_t[1] - d_along_t[0], d_along_t[0]);
      const Vector distance = multiply_add(s, a_of_d, d_left);
      const Vector normal = multiply_add(twelfth, cross(a_of_d, b_of_d), cross(a, b));
      volume = multiply_add(weight, dot(normal, distance), volume);
      if (!kWithGradient) continue;
      const auto spread = [&](const Vector& by_s, const Vector& by_t, Vector(&along_s)[2], Vector(&along_t)[2]) {
        along_s[0] = multiply_add(one - t, by_s, along_s[0]);
        along_s[1] = multiply_add(t, by_s, along_s[1]);
        along_t[0] = multiply_add(one - s, by_t, along_t[0]);
        along_t[1] = multiply_add(s, by_t, along_t[1]);
      };
      const Vector weighted = weight * distance;
      spread(cross(b, weighted), cross(weighted, a), by_m_s, by_m_t);
      const Vector weighted_12 = twelfth * weighted;
      spread(cross(b_of_d, weighted_12), cross(weighted_12, a_of_d), by_d_s, by_d_t);
      const T n[4] = {(one - s) * (one - t), s * (one - t), s * t, (one - s) * t};
      for (int c = 0; c < 4; ++c) by_d[c] = multiply_add(n[c] * weight, normal, by_d[c]);
    }
  }
  if (!kWithGradient) return volume;
  const auto to_corners = [&](const Vector(&along_s)[2], const Vector(&along_t)[2], Vector(&corners)[4]) {
    corners[0] = corners[0] - along_s[0] - along_t[0];
    corners[1] = corners[1] + along_s[0] - along_t[1];
    corners[2] = corners[2] + along_s[1] + along_t[1];
    corners[3] = corners[3] - along_s[1] + along_t[0];
  };
  for (Vector& corner : gradient->by_middle) corner = Vector{};
  to_corners(by_m_s, by_m_t, gradient->by_middle);
  to_corners(by_d_s, by_d_t, by_d);
  for (int c = 0; c < 4; ++c) gradient->by_distance[c] = by_d[c];
  return volume;
}

}  // namespace lipofill::coupling
