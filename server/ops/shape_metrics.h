#pragma once

#include "absl/status/status.h"
#include "server/ops/metric_families.h"

namespace lipofill::server {

/// Shapes that were found directly for a call, and calls that had none. Checked by
/// tests/unit/server/ops/metrics_test.cc.
class ShapeMetrics {
 public:
  explicit ShapeMetrics(prometheus::Registry& registry);

  /// @param status  of the answer; ABORTED where a newer call took the place of this one
  /// @param wall_s  taken to find the shape
  void count(const absl::Status& status, double wall_s);

 private:
  prometheus::Counter& found_;
  prometheus::Counter& superseded_;
  prometheus::Counter& refused_;
  prometheus::Histogram& wall_;
};

}  // namespace lipofill::server
