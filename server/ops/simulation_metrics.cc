#include "server/ops/simulation_metrics.h"

namespace lipofill::server {
namespace {

prometheus::Counter& checkpoints(prometheus::Registry& registry, const char* outcome) {
  return add_counters(registry, "lipofill_checkpoints_total", "Checkpoints of running simulations, by outcome")
      .Add({{"outcome", outcome}});
}

}  // namespace

SimulationMetrics::SimulationMetrics(prometheus::Registry& registry)
    : parked_(add_counter(registry, "lipofill_simulations_parked_total", "Simulations that were left on disk alone")),
      ended_(add_counters(registry, "lipofill_simulations_ended_total", "Simulations that ended, by state")),
      checkpoints_written_(checkpoints(registry, "written")),
      checkpoints_failed_(checkpoints(registry, "failed")),
      checkpoint_bytes_(add_counter(registry, "lipofill_checkpoint_bytes_total", "Bytes of checkpoints written")),
      checkpoint_seconds_(add_histograms(registry, "lipofill_checkpoint_seconds", "Time a checkpoint took by the clock")
                              .Add({}, kSecondsBoundaries)) {}

void SimulationMetrics::count_checkpoint(double seconds, uint64_t bytes) {
  checkpoints_written_.Increment();
  checkpoint_bytes_.Increment(static_cast<double>(bytes));
  checkpoint_seconds_.Observe(seconds);
}

}  // namespace lipofill::server
