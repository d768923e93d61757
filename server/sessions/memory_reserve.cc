#include "server/sessions/memory_reserve.h"

#include <sys/mman.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <new>

namespace lipofill::server {
namespace {

/// A message has at most 4 MiB. Each thread that finds no memory takes a block.
constexpr size_t kBlockBytes = size_t{16} << 20;
constexpr size_t kBlocks = 4;

std::array<std::atomic<void*>, kBlocks> blocks{};

/// The allocation is tried again when this returns.
void find_memory() {
  if (MayFail::is_set() || !MemoryReserve::give_up()) throw std::bad_alloc();
}

}  // namespace

void MemoryReserve::set_up() {
  refill();
  std::set_new_handler(find_memory);
}

void MemoryReserve::refill() {
  for (std::atomic<void*>& block : blocks) {
    if (block != nullptr) continue;
    void* kept = ::mmap(nullptr, kBlockBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (kept == MAP_FAILED) return;
    void* none = nullptr;
    if (!block.compare_exchange_strong(none, kept)) ::munmap(kept, kBlockBytes);
  }
}

bool MemoryReserve::give_up() {
  for (std::atomic<void*>& block : blocks) {
    void* given = block.exchange(nullptr);
    if (given == nullptr) continue;
    ::munmap(given, kBlockBytes);
    return true;
  }
  return false;
}

bool MemoryReserve::is_short() {
  for (const std::atomic<void*>& block : blocks) {
    if (block == nullptr) return true;
  }
  return false;
}

}  // namespace lipofill::server
