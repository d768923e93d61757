// The transport's own allocations. gRPC's C core asks these functions, whose promise is that they
// never return without memory (grpc/support/alloc.h); the library's own keep it by ending the
// process. A program's definition goes before a library's: here, what MemoryReserve keeps back is
// given up first.
// Checked by tests/integration/service/scarce_memory_test.cc.

#include <grpc/support/alloc.h>

#include <cstdlib>

#include "server/sessions/memory_reserve.h"

namespace {

/// Tries until there is memory or nothing is left to give up.
template <typename Allocate>
void* insist(const Allocate& allocate) {
  void* memory = allocate();
  while (memory == nullptr && lipofill::server::MemoryReserve::give_up()) memory = allocate();
  if (memory == nullptr) std::abort();
  return memory;
}

}  // namespace

void* gpr_malloc(size_t size) {
  return size == 0 ? nullptr : insist([=] { return std::malloc(size); });
}

void* gpr_zalloc(size_t size) {
  return size == 0 ? nullptr : insist([=] { return std::calloc(size, 1); });
}

void* gpr_realloc(void* memory, size_t size) {
  return size == 0 && memory == nullptr ? nullptr : insist([=] { return std::realloc(memory, size); });
}
