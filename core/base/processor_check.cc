// Linked into every program as it is, and compiled for any processor of the family (see
// CMakeLists.txt): says what is missing before the first instruction that an older processor does
// not know.

#include <unistd.h>

#include <cstdlib>

namespace {

#if defined(__x86_64__) && !defined(LIPOFILL_NO_PROCESSOR_CHECK)
__attribute__((constructor(101))) void check_processor() {
  __builtin_cpu_init();  // the compiler's own look at the processor may come after this one
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2")) return;
  constexpr char kMessage[] =
      "This build of Lipofill needs a processor with AVX2, FMA and BMI2 (x86-64-v3, 2013 and later). For an older one "
      "build with -DLIPOFILL_ARCH=x86-64.\n";
  if (write(STDERR_FILENO, kMessage, sizeof kMessage - 1) < 0) std::_Exit(1);
  std::_Exit(1);
}
#endif

}  // namespace
