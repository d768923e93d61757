// A library to load before others: large allocations fail, as where memory has run out, while a
// file, LIPOFILL_TEST_SCARCE, says from how many bytes on, and for one of how many.

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

extern "C" void* __libc_malloc(size_t size);
extern "C" void* __libc_memalign(size_t alignment, size_t size);
extern "C" void* __libc_calloc(size_t count, size_t size);
extern "C" void* __libc_realloc(void* memory, size_t size);

namespace {

constexpr size_t kLarge = 100'000;

std::atomic<unsigned> asked = 0;

/// Whether there is no room for so much. The file is read for each that is large.
bool is_refused(size_t size) {
  if (size < kLarge) return false;
  static thread_local bool looks = false;
  if (looks) return false;
  looks = true;
  const char* path = std::getenv("LIPOFILL_TEST_SCARCE");
  std::FILE* file = path != nullptr ? std::fopen(path, "re") : nullptr;
  unsigned long from = 0, one_of = 1;
  const int read = file != nullptr ? std::fscanf(file, "%lu %lu", &from, &one_of) : 0;
  if (file != nullptr) std::fclose(file);
  const bool refused = read == 2 && one_of > 0 && size >= from && asked++ % one_of == 0;
  looks = false;
  if (refused) errno = ENOMEM;
  return refused;
}

}  // namespace

extern "C" void* malloc(size_t size) {
  return is_refused(size) ? nullptr : __libc_malloc(size);
}

extern "C" void* calloc(size_t count, size_t size) {
  return is_refused(count * size) ? nullptr : __libc_calloc(count, size);
}

extern "C" void* realloc(void* memory, size_t size) {
  return is_refused(size) ? nullptr : __libc_realloc(memory, size);
}

extern "C" void* aligned_alloc(size_t alignment, size_t size) {
  return is_refused(size) ? nullptr : __libc_memalign(alignment, size);
}

extern "C" int posix_memalign(void** memory, size_t alignment, size_t size) {
  if (is_refused(size)) return ENOMEM;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
