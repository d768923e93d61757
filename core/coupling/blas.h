#pragma once

// The few BLAS and LAPACK routines of the factorisation, for float and double under one name.
// Matrices are column-major.

extern "C" {
void sgemm_(const char*, const char*, const int*, const int*, const int*, const float*, const float*, const int*,
            const float*, const int*, const float*, float*, const int*);
void dgemm_(const char*, const char*, const int*, const int*, const int*, const double*, const double*, const int*,
            const double*, const int*, const double*, double*, const int*);
void ssyrk_(const char*, const char*, const int*, const int*, const float*, const float*, const int*, const float*,
            float*, const int*);
void dsyrk_(const char*, const char*, const int*, const int*, const double*, const double*, const int*, const double*,
            double*, const int*);
void strsm_(const char*, const char*, const char*, const char*, const int*, const int*, const float*, const float*,
            const int*, float*, const int*);
void dtrsm_(const char*, const char*, const char*, const char*, const int*, const int*, const double*, const double*,
            const int*, double*, const int*);
void spotrf_(const char*, const int*, float*, const int*, int*);
void dpotrf_(const char*, const int*, double*, const int*, int*);
void dtrsv_(const char*, const char*, const char*, const int*, const double*, const int*, double*, const int*);
}

namespace lipofill::coupling::blas {

/// C <- C + alpha A B^T, A (m, k), B (n, k).
inline void gemm_nt(int m, int n, int k, float alpha, const float* a, int lda, const float* b, int ldb, float beta,
                    float* c, int ldc) {
  sgemm_("N", "T", &m, &n, &k, &alpha, a, &lda, b, &ldb, &beta, c, &ldc);
}
inline void gemm_nt(int m, int n, int k, double alpha, const double* a, int lda, const double* b, int ldb, double beta,
                    double* c, int ldc) {
  dgemm_("N", "T", &m, &n, &k, &alpha, a, &lda, b, &ldb, &beta, c, &ldc);
}

/// Lower triangle of C <- beta C + alpha A A^T, A (n, k).
inline void syrk_lower(int n, int k, float alpha, const float* a, int lda, float beta, float* c, int ldc) {
  ssyrk_("L", "N", &n, &k, &alpha, a, &lda, &beta, c, &ldc);
}
inline void syrk_lower(int n, int k, double alpha, const double* a, int lda, double beta, double* c, int ldc) {
  dsyrk_("L", "N", &n, &k, &alpha, a, &lda, &beta, c, &ldc);
}

/// B <- B L^-T, B (m, n).
inline void solve_right_transposed(int m, int n, const float* l, int ldl, float* b, int ldb) {
  const float one = 1.0f;
  strsm_("R", "L", "T", "N", &m, &n, &one, l, &ldl, b, &ldb);
}
inline void solve_right_transposed(int m, int n, const double* l, int ldl, double* b, int ldb) {
  const double one = 1.0;
  dtrsm_("R", "L", "T", "N", &m, &n, &one, l, &ldl, b, &ldb);
}

/// Factors the lower triangle (Cholesky) in place; false when it is not positive definite.
inline bool factor_lower(int n, float* a, int lda) {
  int info = 0;
  spotrf_("L", &n, a, &lda, &info);
  return info == 0;
}
inline bool factor_lower(int n, double* a, int lda) {
  int info = 0;
  dpotrf_("L", &n, a, &lda, &info);
  return info == 0;
}

/// x <- L^-1 x, or L^-T x.
inline void solve_lower(int n, const double* l, int ldl, double* x, bool transposed) {
  const int one = 1;
  dtrsv_("L", transposed ? "T" : "N", "N", &n, l, &ldl, x, &one);
}

}  // namespace lipofill::coupling::blas
