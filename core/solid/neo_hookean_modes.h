#pragma once

#include "core/base/lanes.h"

namespace lipofill::solid {

// The closed forms of which the energy of a neo-Hookean hexahedron is made (neo_hookean_batch.h),
// of several elements side by side. Every function returns an energy and adds its slopes by all its
// arguments.

/// Symmetric tensors: entries 00, 11, 22, 01, 12, 20.
struct SymmetricTensor {
  Lanes m[6];
};

/// Moduli of Psi times volume [J].
struct Moduli {
  Lanes mu, lambda;
};

/// e = sym(u (x) p + v (x) q), under a condition on the stress along `normal`.
struct StrainPair {
  const Vector3<Lanes>&u, &p, &v, &q, &normal;
};
struct StrainPairSlopes {
  Vector3<Lanes>&u, &p, &v, &q, &normal;
};

LIPOFILL_INLINE Vector3<Lanes> multiply(const SymmetricTensor& A, const Vector3<Lanes>& v) {
  return {multiply_add(A.m[0], v.x, multiply_add(A.m[3], v.y, A.m[5] * v.z)),
          multiply_add(A.m[3], v.x, multiply_add(A.m[1], v.y, A.m[4] * v.z)),
          multiply_add(A.m[5], v.x, multiply_add(A.m[4], v.y, A.m[2] * v.z))};
}

/// A += c sym(u (x) v).
LIPOFILL_INLINE void add_symmetric_product(const Lanes& c, const Vector3<Lanes>& u, const Vector3<Lanes>& v,
                                           SymmetricTensor& A) {
  const Vector3<Lanes> w = c * u;
  A.m[0] = multiply_add(w.x, v.x, A.m[0]);
  A.m[1] = multiply_add(w.y, v.y, A.m[1]);
  A.m[2] = multiply_add(w.z, v.z, A.m[2]);
  A.m[3] = multiply_add(0.5 * w.x, v.y, multiply_add(0.5 * w.y, v.x, A.m[3]));
  A.m[4] = multiply_add(0.5 * w.y, v.z, multiply_add(0.5 * w.z, v.y, A.m[4]));
  A.m[5] = multiply_add(0.5 * w.z, v.x, multiply_add(0.5 * w.x, v.z, A.m[5]));
}

LIPOFILL_INLINE SymmetricTensor compute_strain(const StrainPair& of) {
  SymmetricTensor e{};
  add_symmetric_product(fill_lanes(1.0), of.u, of.p, e);
  add_symmetric_product(fill_lanes(1.0), of.v, of.q, e);
  return e;
}

LIPOFILL_INLINE Lanes compute_trace(const SymmetricTensor& A) {
  return A.m[0] + A.m[1] + A.m[2];
}

LIPOFILL_INLINE Lanes compute_square(const SymmetricTensor& A) {
  const Lanes diagonal = multiply_add(A.m[0], A.m[0], multiply_add(A.m[1], A.m[1], A.m[2] * A.m[2]));
  const Lanes off = multiply_add(A.m[3], A.m[3], multiply_add(A.m[4], A.m[4], A.m[5] * A.m[5]));
  return multiply_add(fill_lanes(2.0), off, diagonal);
}

/// sigma = 2 mu e + lambda tr (I - n n^T); returns the energy. `e` has no part along n that does
/// work.
LIPOFILL_INLINE Lanes add_slopes_of_strain(const Moduli& moduli, const SymmetricTensor& e, const Lanes& trace,
                                           const Lanes& inverse_square, const StrainPair& of,
                                           const StrainPairSlopes& slopes, SymmetricTensor& stress) {
  for (int k = 0; k < 6; ++k) stress.m[k] = 2.0 * moduli.mu * e.m[k];
  const Lanes pressure = moduli.lambda * trace;
  for (int k = 0; k < 3; ++k) stress.m[k] += pressure;
  add_symmetric_product(-pressure * inverse_square, of.normal, of.normal, stress);
  slopes.u = slopes.u + multiply(stress, of.p);
  slopes.v = slopes.v + multiply(stress, of.q);
  slopes.p = slopes.p + multiply(stress, of.u);
  slopes.q = slopes.q + multiply(stress, of.v);
  return multiply_add(moduli.mu, compute_square(e), 0.5 * pressure * trace);
}

/// Psi(P e P) with P = I - n n^T: plane stress, sigma n = 0.
LIPOFILL_INLINE Lanes add_plane_stress(const Moduli& moduli, const StrainPair& of, const StrainPairSlopes& slopes) {
  SymmetricTensor e = compute_strain(of);
  const Lanes inverse = 1.0 / dot(of.normal, of.normal);
  const Vector3<Lanes> along = multiply(e, of.normal);
  const Lanes normal_strain = inverse * dot(of.normal, along);
  const Vector3<Lanes> half = multiply_add(-0.5 * normal_strain, of.normal, along);
  add_symmetric_product(-2.0 * inverse, half, of.normal, e);
  SymmetricTensor stress;
  const Lanes energy = add_slopes_of_strain(moduli, e, compute_trace(e), inverse, of, slopes, stress);
  slopes.normal = multiply_add(-2.0 * inverse, multiply(stress, along), slopes.normal);
  return energy;
}

/// Psi(e) with the strain along n free: n . sigma n = 0.
LIPOFILL_INLINE Lanes add_normal_stress_free(const Moduli& moduli, const StrainPair& of,
                                             const StrainPairSlopes& slopes) {
  SymmetricTensor e = compute_strain(of);
  const Lanes inverse = 1.0 / dot(of.normal, of.normal);
  const Vector3<Lanes> along = multiply(e, of.normal);
  const Lanes normal_strain = inverse * dot(of.normal, along);
  add_symmetric_product(-inverse * normal_strain, of.normal, of.normal, e);
  const Lanes trace = compute_trace(e);
  SymmetricTensor stress;
  const Lanes energy_of_plane = add_slopes_of_strain(moduli, e, trace, inverse, of, slopes, stress);
  const Lanes slope = multiply_add(2.0 * moduli.mu, normal_strain, moduli.lambda * trace);
  const Vector3<Lanes> turning = multiply_add(-normal_strain, of.normal, along);
  slopes.normal = multiply_add(-2.0 * inverse * slope, turning, slopes.normal);
  return energy_of_plane;
}

/// mu |sym(w (x) g)|^2 + lambda/2 (w . g)^2.
LIPOFILL_INLINE Lanes add_warping(const Moduli& moduli, const Vector3<Lanes>& w, const Vector3<Lanes>& g,
                                  Vector3<Lanes>& by_w, Vector3<Lanes>& by_g) {
  const Lanes ww = dot(w, w), gg = dot(g, g), wg = dot(w, g);
  const Lanes along = (moduli.mu + moduli.lambda) * wg;
  by_w = by_w + multiply_add(moduli.mu * gg, w, along * g);
  by_g = by_g + multiply_add(moduli.mu * ww, g, along * w);
  return 0.5 * multiply_add(moduli.mu * ww, gg, along * wg);
}

/// (mu + lambda/2) (w . g)^2.
LIPOFILL_INLINE Lanes add_normal_warping(const Moduli& moduli, const Vector3<Lanes>& w, const Vector3<Lanes>& g,
                                         Vector3<Lanes>& by_w, Vector3<Lanes>& by_g) {
  const Lanes along = (2.0 * moduli.mu + moduli.lambda) * dot(w, g);
  by_w = multiply_add(along, g, by_w);
  by_g = multiply_add(along, w, by_g);
  return 0.5 * along * dot(w, g);
}

/// 64 v of the trilinear hexahedron with the modes s, and its slopes by them:
///
///     64 v = det[s_1 s_2 s_4] + 1/3 (det[s_1 s_3 s_5] + det[s_3 s_2 s_6] + det[s_5 s_6 s_4])
template <typename T>
LIPOFILL_INLINE T compute_volume(const Vector3<T> (&s)[8], Vector3<T> (&slope)[8]) {
  const T third = T{} + 1.0 / 3.0;
  slope[0] = slope[7] = Vector3<T>{};
  slope[1] = multiply_add(third, cross(s[3], s[5]), cross(s[2], s[4]));
  slope[2] = multiply_add(third, cross(s[6], s[3]), cross(s[4], s[1]));
  slope[4] = multiply_add(third, cross(s[5], s[6]), cross(s[1], s[2]));
  slope[3] = third * (cross(s[2], s[6]) + cross(s[5], s[1]));
  slope[5] = third * (cross(s[6], s[4]) + cross(s[1], s[3]));
  slope[6] = third * (cross(s[4], s[5]) + cross(s[3], s[2]));
  const T products = dot(s[1], cross(s[3], s[5])) + dot(s[2], cross(s[6], s[3])) + dot(s[4], cross(s[5], s[6]));
  return multiply_add(third, products, dot(s[4], cross(s[1], s[2])));
}

}  // namespace lipofill::solid
