#pragma once

#include <string>

#include "server/ops/metric_families.h"

namespace lipofill::server {

/// Figures of one method of the service, good as long as the metrics live.
struct MethodMetrics {
  prometheus::Counter& started;
  prometheus::Gauge& in_flight;
  prometheus::Counter& sent_bytes;
  prometheus::Histogram& seconds;
};

/// Calls by method. Methods are those of registered services, so that there is a bounded number of
/// them. Checked by tests/unit/server/ops/metrics_test.cc.
class CallMetrics {
 public:
  explicit CallMetrics(prometheus::Registry& registry);

  MethodMetrics of_method(const std::string& method);
  void count_handled(const std::string& method, const std::string& code);
  /// Counts a call that was refused to its caller, by one of a bounded number of reasons.
  void count_refused(const std::string& reason);

 private:
  prometheus::Family<prometheus::Counter>& started_;
  prometheus::Family<prometheus::Gauge>& in_flight_;
  prometheus::Family<prometheus::Counter>& handled_;
  prometheus::Family<prometheus::Counter>& refused_;
  prometheus::Family<prometheus::Counter>& sent_bytes_;
  prometheus::Family<prometheus::Histogram>& seconds_;
};

}  // namespace lipofill::server
