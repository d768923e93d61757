#pragma once

#include <string>
#include <vector>

#include "lipofill/v1/model.pb.h"
#include "lipofill/v1/simulation.pb.h"

namespace lipofill::testing {

/// An injection and the step after which it was taken into the plan.
struct TakenInjection {
  uint64_t step = 0;
  v1::Injection injection;
};

/// What a simulation is expected to be: its plan as it was created, and what was injected since.
struct Course {
  v1::SimulationSpec plan;
  std::vector<TakenInjection> injections;
};

struct Outcome {
  std::string state_hash;
  uint64_t steps = 0;
};

/// Runs it in this process from the first step to the last, or to `until_step`.
Outcome run_unbroken(const v1::ModelSpec& model, const Course& course, uint64_t until_step = UINT64_MAX);

}  // namespace lipofill::testing
