#include "tests/bench/micro/micro_case.h"

#include <cstdlib>
#include <iostream>
#include <utility>

namespace lipofill::bench {
namespace {

template <typename T>
T value_or_end(absl::StatusOr<T> result) {
  if (result.ok()) return *std::move(result);
  std::cerr << "lipofill_microbench: " << result.status() << "\n";
  std::exit(1);
}

}  // namespace

MicroCase& micro_case(int64_t scale) {
  static std::unique_ptr<MicroCase> last;
  if (last != nullptr && last->jaw.scale == scale) return *last;
  last = nullptr;
  last = std::make_unique<MicroCase>();
  last->jaw = value_or_end(make_jaw_angle(static_cast<int>(scale)));
  last->parts = value_or_end(StepParts::create(last->jaw));
  last->parts->move_to_wave();
  last->step = last->parts->linear_step();
  last->simulation = value_or_end(simulation::Simulation::create(last->jaw.model, last->jaw.spec));
  return *last;
}

}  // namespace lipofill::bench
