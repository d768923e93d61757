#pragma once

#include <nlohmann/json.hpp>

#include "core/mechanics/step_cost.h"
#include "tests/bench/measure.h"

namespace lipofill::bench {

/// What steps say of themselves: time by phase, and what was done how often.
class StepCosts {
 public:
  void add(const mechanics::StepCost& cost);
  void add(const StepCosts& others);

  /// {"times": {"element": ..., ...}, "per_step": {"factorisations": ..., ...}}
  nlohmann::ordered_json to_json() const;

 private:
  PhaseSamples times_;
  int steps_ = 0;
  mechanics::StepCost sum_;
};

}  // namespace lipofill::bench
