#pragma once

#include <string>

#include "tests/bench/route.h"

namespace lipofill::bench {

/// Writes down what a route does as it goes.
class PhaseClock {
 public:
  /// What was done since the last call.
  void done(const std::string& phase) { phases_.push_back({phase, watch_.lap()}); }
  Phases take() { return std::move(phases_); }

 private:
  Phases phases_;
  Stopwatch watch_;
};

}  // namespace lipofill::bench
