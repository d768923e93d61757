#pragma once

#include <cstdint>

#include "server/ops/metric_families.h"

namespace lipofill::server {

/// Viewers and the frames they are sent. Checked by tests/unit/server/ops/metrics_test.cc.
class ViewerMetrics {
 public:
  explicit ViewerMetrics(prometheus::Registry& registry);

  void count_come() { viewers_.Increment(); }
  void count_gone() { viewers_.Decrement(); }
  void count_frame_sent(uint64_t skipped_before);

 private:
  prometheus::Gauge& viewers_;
  prometheus::Counter& frames_sent_;
  prometheus::Counter& frames_skipped_;
};

}  // namespace lipofill::server
