#include "core/coupling/thread_random.h"

#include <dlfcn.h>

#include <cstdlib>

namespace {

/// The C library's own algorithm and state, one for each thread, seeded with 1 as the standard has
/// it.
class Generator {
 public:
  Generator() { ::initstate_r(1, state_, sizeof state_, &data_); }
  void seed(unsigned int value) { ::srandom_r(value, &data_); }
  int draw() {
    int number = 0;
    ::random_r(&data_, &number);
    return number;
  }

 private:
  char state_[128] = {};
  random_data data_ = {};
};

Generator& of_this_thread() {
  thread_local Generator generator;
  return generator;
}

}  // namespace

extern "C" int rand() noexcept {
  return of_this_thread().draw();
}
extern "C" void srand(unsigned int seed) noexcept {
  of_this_thread().seed(seed);
}

namespace lipofill::coupling {

bool has_random_numbers_of_its_own() {
  static const bool found = ::dlsym(RTLD_DEFAULT, "rand") == reinterpret_cast<void*>(&::rand) &&
                            ::dlsym(RTLD_DEFAULT, "srand") == reinterpret_cast<void*>(&::srand);
  return found;
}

}  // namespace lipofill::coupling
