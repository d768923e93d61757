#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

// Everything here is inlined, so that no vector crosses a call on processors whose calls cannot
// pass one.
#define LIPOFILL_INLINE inline __attribute__((always_inline))
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace lipofill {

inline constexpr int kLanes = 4;

/// A number of each of kLanes things - hexahedra, pieces of a film cell - worked on side by side.
/// Operators work lane by lane, comparisons give masks, and mask ? a : b chooses. Four fill a
/// register of AVX2; eight in two registers, as measured, only spill.
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using LaneMask = std::int64_t __attribute__((vector_size(kLanes * sizeof(double))));

/// Returns a b + c, rounded once where the processor can. Written out, since the compiler is told
/// to fuse nothing by itself: results must not depend on how it schedules an expression.
LIPOFILL_INLINE Lanes multiply_add(Lanes a, Lanes b, Lanes c) {
#if defined(__AVX2__) && defined(__FMA__)
  return _mm256_fmadd_pd(a, b, c);
#else
  return a * b + c;
#endif
}
LIPOFILL_INLINE double multiply_add(double a, double b, double c) {
#if defined(__FMA__)
  return __builtin_fma(a, b, c);
#else
  return a * b + c;
#endif
}

LIPOFILL_INLINE Lanes square_root(Lanes a) {
#if defined(__AVX2__) && defined(__FMA__)
  return _mm256_sqrt_pd(a);
#else
  Lanes root;
  for (int lane = 0; lane < kLanes; ++lane) root[lane] = std::sqrt(a[lane]);
  return root;
#endif
}

LIPOFILL_INLINE bool any(LaneMask mask) {
#if defined(__AVX2__) && defined(__FMA__)
  return _mm256_movemask_pd(_mm256_castsi256_pd(reinterpret_cast<__m256i>(mask))) != 0;
#else
  std::int64_t some = 0;
  for (int lane = 0; lane < kLanes; ++lane) some |= mask[lane];
  return some != 0;
#endif
}

LIPOFILL_INLINE Lanes fill_lanes(double value) {
  return Lanes{value, value, value, value};
}
LIPOFILL_INLINE Lanes load(const double* values) {
  Lanes lanes;
  std::memcpy(&lanes, values, sizeof lanes);
  return lanes;
}
LIPOFILL_INLINE void store(Lanes lanes, double* values) {
  std::memcpy(values, &lanes, sizeof lanes);
}
LIPOFILL_INLINE void add_to(Lanes lanes, double* values) {
  store(load(values) + lanes, values);
}

/// Turns rows into columns: lane j of rows[i] becomes lane i of rows[j].
LIPOFILL_INLINE void transpose(Lanes (&rows)[kLanes]) {
  const Lanes even01 = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6);
  const Lanes odd01 = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7);
  const Lanes even23 = __builtin_shufflevector(rows[2], rows[3], 0, 4, 2, 6);
  const Lanes odd23 = __builtin_shufflevector(rows[2], rows[3], 1, 5, 3, 7);
  rows[0] = __builtin_shufflevector(even01, even23, 0, 1, 4, 5);
  rows[1] = __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5);
  rows[2] = __builtin_shufflevector(even01, even23, 2, 3, 6, 7);
  rows[3] = __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7);
}

/// A vector of space of one thing (T = double) or of several (T = Lanes).
template <typename T>
struct Vector3 {
  T x, y, z;

  LIPOFILL_INLINE friend Vector3 operator+(const Vector3& a, const Vector3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  LIPOFILL_INLINE friend Vector3 operator-(const Vector3& a, const Vector3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  LIPOFILL_INLINE friend Vector3 operator*(const T& s, const Vector3& a) { return {s * a.x, s * a.y, s * a.z}; }
};
/// Returns s a + b.
template <typename T>
LIPOFILL_INLINE Vector3<T> multiply_add(const T& s, const Vector3<T>& a, const Vector3<T>& b) {
  return {multiply_add(s, a.x, b.x), multiply_add(s, a.y, b.y), multiply_add(s, a.z, b.z)};
}
template <typename T>
LIPOFILL_INLINE T dot(const Vector3<T>& a, const Vector3<T>& b) {
  return multiply_add(a.x, b.x, multiply_add(a.y, b.y, a.z * b.z));
}
template <typename T>
LIPOFILL_INLINE Vector3<T> cross(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Points kLanes places apart from one another: lane k is points[3 k' ...] of the index places[k]
/// (3, n_points).
LIPOFILL_INLINE Vector3<Lanes> gather_points(const double* points, const int (&places)[kLanes]) {
  Vector3<Lanes> gathered;
  for (int lane = 0; lane < kLanes; ++lane) {
    const double* const point = points + 3 * static_cast<std::ptrdiff_t>(places[lane]);
    gathered.x[lane] = point[0];
    gathered.y[lane] = point[1];
    gathered.z[lane] = point[2];
  }
  return gathered;
}

}  // namespace lipofill

#pragma GCC diagnostic pop
