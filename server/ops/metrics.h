#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "server/ops/call_metrics.h"
#include "server/ops/shape_metrics.h"
#include "server/ops/simulation_metrics.h"
#include "server/ops/step_metrics.h"
#include "server/ops/viewer_metrics.h"

namespace lipofill::server {

/// Everything the daemon counts, in the names and units of Prometheus (seconds, bytes, _total of
/// what only grows). Calls are thread-safe and cheap enough for every step and every message.
/// Checked by tests/unit/server/ops/metrics_test.cc and tests/integration/service/metrics_test.cc.
class Metrics {
 public:
  Metrics() = default;
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  StepMetrics& steps() { return steps_; }
  SimulationMetrics& simulations() { return simulations_; }
  ViewerMetrics& viewers() { return viewers_; }
  CallMetrics& calls() { return calls_; }
  ShapeMetrics& shapes() { return shapes_; }

  /// A figure that is looked up at each scrape, by `refresh`.
  prometheus::Gauge& add_gauge(const std::string& name, const std::string& help, const prometheus::Labels& labels = {});
  prometheus::Counter& add_counter(const std::string& name, const std::string& help);
  /// Adds a function that is called before each scrape, on the thread that serves it.
  void add_refresh(std::function<void()> refresh);

  /// Returns the figures of a scrape; refreshes them first.
  std::vector<prometheus::MetricFamily> collect() const;

 private:
  prometheus::Registry registry_;
  StepMetrics steps_{registry_};
  SimulationMetrics simulations_{registry_};
  ViewerMetrics viewers_{registry_};
  CallMetrics calls_{registry_};
  ShapeMetrics shapes_{registry_};

  mutable std::mutex refresh_mutex_;
  std::vector<std::function<void()>> refreshes_;
};

}  // namespace lipofill::server
