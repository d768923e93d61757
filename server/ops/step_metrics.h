#pragma once

#include <array>

#include "server/ops/metric_families.h"

namespace lipofill::server {

/// Duration of a step of a simulation [s] and the work of its solver.
struct StepFigures {
  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< of the thread; what the phases leave of it is bookkeeping
  double element_cpu_s = 0.0;
  double factor_cpu_s = 0.0;
  double solve_cpu_s = 0.0;
  double film_cpu_s = 0.0;
  double coupling_cpu_s = 0.0;
  int film_iterations = 0;
  int newton_iterations = 0;
  int iterative_iterations = 0;
  int factorisations = 0;
  int tissue_solves = 0;
  int fallbacks = 0;
};

/// These metrics tell what the steps of all simulations cost. Checked by
/// tests/unit/server/ops/metrics_test.cc.
class StepMetrics {
 public:
  explicit StepMetrics(prometheus::Registry& registry);
  void count(const StepFigures& step);

 private:
  prometheus::Counter& steps_;
  prometheus::Histogram& wall_;
  std::array<prometheus::Histogram*, 6> phases_{};  ///< as in count()
  std::array<prometheus::Counter*, 3> iterations_{};
  prometheus::Counter& factorisations_;
  prometheus::Counter& tissue_solves_;
  prometheus::Counter& fallbacks_;
};

}  // namespace lipofill::server
