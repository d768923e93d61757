#pragma once

namespace lipofill::testing {

/// Blocks that the calling thread has taken from the heap so far, by malloc and its kin or by
/// operator new, in this program and in the libraries it calls. Linking allocation_counter.cc into
/// a program is what counts them.
long count_allocations();

/// What a call takes from the heap.
template <typename Call>
long count_allocations_of(const Call& call) {
  const long before = count_allocations();
  call();
  return count_allocations() - before;
}

}  // namespace lipofill::testing
