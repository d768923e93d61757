#include "core/coupling/algebra_threads.h"

#include <omp.h>

extern "C" void openblas_set_num_threads(int n_threads);

namespace lipofill::coupling {

void keep_algebra_on_this_thread() {
  // Debian's CHOLMOD opens OpenMP regions of four threads for copying loops. The first setting is a thread's own, the
  // second the process's.
  omp_set_max_active_levels(0);
  static const bool once = [] {
    openblas_set_num_threads(1);
    return true;
  }();
  static_cast<void>(once);
}

}  // namespace lipofill::coupling
