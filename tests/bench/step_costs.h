#pragma once

#include <nlohmann/json.hpp>

#include "core/step/step_cost.h"
#include "tests/bench/measure.h"

namespace lipofill::bench {

/// What steps say of themselves: time by phase, and what was done how often.
class StepCosts {
 public:
  void add(const step::StepCost& cost);
  void add(const StepCosts& others);

  /// {"times": {"element": ..., ...}, "per_step": {"factorisations": ..., ...}}
  nlohmann::ordered_json to_json() const;

 private:
  PhaseSamples times_;
  int steps_ = 0;
  step::StepCost sum_;
};

}  // namespace lipofill::bench
