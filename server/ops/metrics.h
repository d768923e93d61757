#pragma once

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace lipofill::server {

/// Duration of a step of a simulation [s] and the work of its solver.
struct StepFigures {
  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< the thread took it; what the phases leave of it is bookkeeping
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

/// Figures of one method of the service, good as long as the metrics live.
struct MethodMetrics {
  prometheus::Counter& started;
  prometheus::Gauge& in_flight;
  prometheus::Counter& sent_bytes;
  prometheus::Histogram& seconds;
};

/// Everything the daemon counts, in the names and units of Prometheus (seconds, bytes, _total of
/// what only grows). Calls are thread-safe and cheap enough for every step and every message.
/// Checked by tests/unit/server/ops/metrics_test.cc and tests/integration/service/metrics_test.cc.
class Metrics {
 public:
  Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  // Simulations.
  void count_step(const StepFigures& step);
  void count_parked_simulation();
  void count_ended_simulation(const std::string& state);

  // Checkpoints.
  void count_checkpoint(double seconds, uint64_t bytes);
  void count_failed_checkpoint();

  // Viewers.
  void count_viewer_come() { viewers_.Increment(); }
  void count_viewer_gone() { viewers_.Decrement(); }
  void count_frame_sent(uint64_t skipped_before);

  // Calls. Methods are those of registered services, so that there is a bounded number of them.
  MethodMetrics of_method(const std::string& method);
  void count_handled(const std::string& method, const std::string& code);
  /// Counts a call that was refused to its caller, by one of a bounded number of reasons.
  void count_refused(const std::string& reason);

  /// A figure that is looked up at each scrape, by `refresh`.
  prometheus::Gauge& add_gauge(const std::string& name, const std::string& help, const prometheus::Labels& labels = {});
  prometheus::Counter& add_counter(const std::string& name, const std::string& help);
  /// Adds a function that is called before each scrape, on the thread that serves it.
  void add_refresh(std::function<void()> refresh);

  /// Returns the figures of a scrape; refreshes them first.
  std::vector<prometheus::MetricFamily> collect() const;

 private:
  prometheus::Registry registry_;

  prometheus::Counter& steps_;
  prometheus::Histogram& step_wall_;
  std::array<prometheus::Histogram*, 6> step_phases_{};  ///< they are in the order of count_step
  std::array<prometheus::Counter*, 3> iterations_{};
  prometheus::Counter& factorisations_;
  prometheus::Counter& tissue_solves_;
  prometheus::Counter& fallbacks_;
  prometheus::Counter& parked_;
  prometheus::Family<prometheus::Counter>& ended_;

  prometheus::Counter& checkpoints_written_;
  prometheus::Counter& checkpoints_failed_;
  prometheus::Counter& checkpoint_bytes_;
  prometheus::Histogram& checkpoint_seconds_;

  prometheus::Gauge& viewers_;
  prometheus::Counter& frames_sent_;
  prometheus::Counter& frames_skipped_;

  prometheus::Family<prometheus::Counter>& calls_started_;
  prometheus::Family<prometheus::Gauge>& calls_in_flight_;
  prometheus::Family<prometheus::Counter>& calls_handled_;
  prometheus::Family<prometheus::Counter>& calls_refused_;
  prometheus::Family<prometheus::Counter>& sent_bytes_;
  prometheus::Family<prometheus::Histogram>& call_seconds_;

  mutable std::mutex refresh_mutex_;
  std::vector<std::function<void()>> refreshes_;
};

}  // namespace lipofill::server
