#include "core/coupling/algebra_threads.h"

#include <omp.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdlib>
#include <optional>

extern "C" {
void openblas_set_num_threads(int n_threads);
char* openblas_get_corename();
// OpenBLAS has no call that chooses kernels; these two read OPENBLAS_CORETYPE again. Builds for one
// processor alone lack them.
[[gnu::weak]] void gotoblas_dynamic_init();
[[gnu::weak]] void gotoblas_dynamic_quit();
}

namespace lipofill::coupling {
namespace {

/// The oldest family with AVX2 and FMA, which every x86-64-v3 processor can run.
constexpr const char* kPinnedKernels = "Haswell";
constexpr const char* kVariable = "OPENBLAS_CORETYPE";

bool can_run_pinned_kernels() {
#ifdef __x86_64__
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && gotoblas_dynamic_init != nullptr &&
         gotoblas_dynamic_quit != nullptr;
#else
  return false;
#endif
}

/// Pins the kernels and puts the variable back, so that programs which this one starts choose for
/// themselves.
bool pin_kernels() {
  if (!can_run_pinned_kernels()) return false;
  const char* given = std::getenv(kVariable);
  const std::optional<std::string> before = given == nullptr ? std::nullopt : std::optional<std::string>(given);
  setenv(kVariable, kPinnedKernels, 1);
  gotoblas_dynamic_quit();
  gotoblas_dynamic_init();
  if (before.has_value()) {
    setenv(kVariable, before->c_str(), 1);
  } else {
    unsetenv(kVariable);
  }
  return true;
}

/// Eigen cuts long sums of products by the size of the processor's caches, unless it is told one.
bool pin_blocking() {
  constexpr std::ptrdiff_t kFirst = 48 << 10, kSecond = 2 << 20, kThird = 105 << 20;  // [B]
  Eigen::setCpuCacheSizes(kFirst, kSecond, kThird);
  return true;
}

// Before main() there is one thread, which neither reads the environment nor computes meanwhile.
const bool tried_to_pin = pin_blocking() && pin_kernels();

}  // namespace

void pin_algebra_to_this_thread() {
  // Debian's CHOLMOD opens OpenMP regions of four threads for copying loops. The first setting is a
  // thread's own, the second the process's.
  omp_set_max_active_levels(0);
  static const bool once = [] {
    openblas_set_num_threads(1);
    return true;
  }();
  static_cast<void>(once);
}

std::string algebra_kernels() {
  return openblas_get_corename();
}

bool has_pinned_kernels() {
  return tried_to_pin && algebra_kernels() == kPinnedKernels;
}

}  // namespace lipofill::coupling
