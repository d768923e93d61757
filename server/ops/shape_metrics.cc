#include "server/ops/shape_metrics.h"

namespace lipofill::server {

ShapeMetrics::ShapeMetrics(prometheus::Registry& registry)
    : found_(add_counter(registry, "lipofill_shapes_found_total", "Settled shapes found directly for a call")),
      superseded_(add_counter(registry, "lipofill_shapes_superseded_total",
                              "Calls for a shape that a newer call of the same drag took the place of")),
      refused_(add_counter(registry, "lipofill_shapes_refused_total", "Calls for a shape that had none")),
      wall_(add_histograms(registry, "lipofill_shape_wall_seconds", "Time to find a shape by the clock")
                .Add({}, kSecondsBoundaries)) {}

void ShapeMetrics::count(const absl::Status& status, double wall_s) {
  if (status.ok()) {
    found_.Increment();
    wall_.Observe(wall_s);
  } else {
    (absl::IsAborted(status) ? superseded_ : refused_).Increment();
  }
}

}  // namespace lipofill::server
