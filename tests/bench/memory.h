#pragma once

#include <nlohmann/json.hpp>

#include "absl/status/statusor.h"
#include "tests/bench/jaw_angle.h"

namespace lipofill::bench {

/// Memory of this process that is in RAM now, and its largest value since forget_peak() [MB]. 0
/// where /proc is missing.
double resident_mb();
double peak_resident_mb();
void forget_peak();

/// Memory that several simulations of one model take, each after some steps.
struct SessionMemory {
  int sessions = 0;
  double mb_each = 0.0;
};
absl::StatusOr<SessionMemory> measure_session_memory(const JawAngle& jaw, int sessions, int steps);

}  // namespace lipofill::bench
