#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "tests/bench/service/process_figures.h"

namespace lipofill::bench {

struct Phase {
  std::string name;
  double wall_ms = 0.0;
  double cpu_ms = 0.0;  ///< this process took it
};

/// Times pieces of work that follow each other.
class PhaseTimes {
 public:
  /// The work since the last call, or since the beginning, was `name`.
  void end(const std::string& name) {
    const auto now = std::chrono::steady_clock::now();
    const double cpu_s = process_cpu_s();
    phases_.push_back({name, std::chrono::duration<double, std::milli>(now - since_).count(), 1e3 * (cpu_s - cpu_s_)});
    since_ = now;
    cpu_s_ = cpu_s;
  }
  const std::vector<Phase>& phases() const { return phases_; }

 private:
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
  double cpu_s_ = process_cpu_s();
  std::vector<Phase> phases_;
};

}  // namespace lipofill::bench
