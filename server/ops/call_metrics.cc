#include "server/ops/call_metrics.h"

namespace lipofill::server {

CallMetrics::CallMetrics(prometheus::Registry& registry)
    : started_(add_counters(registry, "lipofill_rpc_started_total", "Calls that began, by method")),
      in_flight_(add_gauges(registry, "lipofill_rpc_in_flight", "Calls under way, by method")),
      handled_(add_counters(registry, "lipofill_rpc_handled_total", "Calls that ended, by method and status code")),
      refused_(add_counters(registry, "lipofill_rpc_refused_total",
                            "Calls that were refused for who made them or what they may do, by reason")),
      sent_bytes_(add_counters(registry, "lipofill_rpc_sent_bytes_total", "Bytes of messages sent, by method")),
      seconds_(add_histograms(registry, "lipofill_rpc_seconds", "Time a call took by the clock, by method")) {
  // These counters exist from the start, so that the first refusal is an increase.
  for (const char* reason : {"NO_CREDENTIALS", "ROLE_TOO_LOW", "PATIENT_NOT_YOURS"}) {
    refused_.Add({{"reason", reason}});
  }
}

MethodMetrics CallMetrics::of_method(const std::string& method) {
  const prometheus::Labels labels = {{"method", method}};
  return {started_.Add(labels), in_flight_.Add(labels), sent_bytes_.Add(labels),
          seconds_.Add(labels, kSecondsBoundaries)};
}

void CallMetrics::count_handled(const std::string& method, const std::string& code) {
  handled_.Add({{"method", method}, {"code", code}}).Increment();
}

void CallMetrics::count_refused(const std::string& reason) {
  refused_.Add({{"reason", reason}}).Increment();
}

}  // namespace lipofill::server
