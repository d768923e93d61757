// A library to load before others: large allocations fail, as where memory has run out, while a
// file, LIPOFILL_TEST_SCARCE, says from how many bytes on, and for one of how many. Those of the
// transport's own library do not, which ends the process where it has none.

#include <dlfcn.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

extern "C" void* __libc_malloc(size_t size);
extern "C" void* __libc_memalign(size_t alignment, size_t size);
extern "C" void* __libc_calloc(size_t count, size_t size);
extern "C" void* __libc_realloc(void* memory, size_t size);

namespace {

constexpr size_t kLarge = 100'000;

std::atomic<unsigned> asked = 0;

bool is_of_transport(const void* caller) {
  Dl_info info{};
  if (::dladdr(caller, &info) == 0 || info.dli_fname == nullptr) return false;
  return std::strstr(info.dli_fname, "libgpr") != nullptr || std::strstr(info.dli_fname, "libgrpc.so") != nullptr;
}

/// Whether there is no room for so much. The file is read for each that is large.
bool is_refused(size_t size, const void* caller) {
  if (size < kLarge) return false;
  static thread_local bool looks = false;
  if (looks) return false;
  looks = true;
  const char* path = std::getenv("LIPOFILL_TEST_SCARCE");
  std::FILE* file = path != nullptr ? std::fopen(path, "re") : nullptr;
  unsigned long from = 0, one_of = 1;
  const int read = file != nullptr ? std::fscanf(file, "%lu %lu", &from, &one_of) : 0;
  if (file != nullptr) std::fclose(file);
  const bool refused = read == 2 && one_of > 0 && size >= from && !is_of_transport(caller) && asked++ % one_of == 0;
  looks = false;
  if (refused) errno = ENOMEM;
  return refused;
}

}  // namespace

extern "C" void* malloc(size_t size) {
  return is_refused(size, __builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}

extern "C" void* calloc(size_t count, size_t size) {
  return is_refused(count * size, __builtin_return_address(0)) ? nullptr : __libc_calloc(count, size);
}

extern "C" void* realloc(void* memory, size_t size) {
  return is_refused(size, __builtin_return_address(0)) ? nullptr : __libc_realloc(memory, size);
}

extern "C" void* aligned_alloc(size_t alignment, size_t size) {
  return is_refused(size, __builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
}

extern "C" int posix_memalign(void** memory, size_t alignment, size_t size) {
  if (is_refused(size, __builtin_return_address(0))) return ENOMEM;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
