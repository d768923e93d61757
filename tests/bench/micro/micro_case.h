#pragma once

#include <memory>

#include "core/simulation/simulation.h"
#include "tests/bench/linear_step.h"

namespace lipofill::bench {

/// What the micro-benchmarks of one size share.
struct MicroCase {
  JawAngle jaw;
  std::unique_ptr<StepParts> parts;
  LinearStep step;
  std::unique_ptr<simulation::Simulation> simulation;  ///< it is at rest
};

/// The case of a scale, made when it is first asked for; the last one made is kept. Ends the
/// program when it cannot be.
MicroCase& micro_case(int64_t scale);

}  // namespace lipofill::bench
