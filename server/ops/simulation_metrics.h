#pragma once

#include <cstdint>
#include <string>

#include "server/ops/metric_families.h"

namespace lipofill::server {

/// These metrics tell what becomes of simulations: they end, are parked, and keep their state.
/// Checked by tests/unit/server/ops/metrics_test.cc.
class SimulationMetrics {
 public:
  explicit SimulationMetrics(prometheus::Registry& registry);

  void count_parked() { parked_.Increment(); }
  void count_ended(const std::string& state) { ended_.Add({{"state", state}}).Increment(); }
  void count_checkpoint(double seconds, uint64_t bytes);
  void count_failed_checkpoint() { checkpoints_failed_.Increment(); }

 private:
  prometheus::Counter& parked_;
  prometheus::Family<prometheus::Counter>& ended_;
  prometheus::Counter& checkpoints_written_;
  prometheus::Counter& checkpoints_failed_;
  prometheus::Counter& checkpoint_bytes_;
  prometheus::Histogram& checkpoint_seconds_;
};

}  // namespace lipofill::server
