#include "server/ops/metrics.h"

#include <utility>

namespace lipofill::server {

prometheus::Gauge& Metrics::add_gauge(const std::string& name, const std::string& help,
                                      const prometheus::Labels& labels) {
  return add_gauges(registry_, name.c_str(), help.c_str()).Add(labels);
}

prometheus::Counter& Metrics::add_counter(const std::string& name, const std::string& help) {
  return add_counters(registry_, name.c_str(), help.c_str()).Add({});
}

void Metrics::add_refresh(std::function<void()> refresh) {
  const std::lock_guard lock(refresh_mutex_);
  refreshes_.push_back(std::move(refresh));
}

std::vector<prometheus::MetricFamily> Metrics::collect() const {
  const std::lock_guard lock(refresh_mutex_);
  for (const auto& refresh : refreshes_) refresh();
  return registry_.Collect();
}

}  // namespace lipofill::server
