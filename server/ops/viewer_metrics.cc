#include "server/ops/viewer_metrics.h"

namespace lipofill::server {

ViewerMetrics::ViewerMetrics(prometheus::Registry& registry)
    : viewers_(add_gauges(registry, "lipofill_viewers", "Viewers that watch now").Add({})),
      frames_sent_(add_counter(registry, "lipofill_frames_sent_total", "Frames sent to viewers")),
      frames_skipped_(add_counter(registry, "lipofill_frames_skipped_total",
                                  "Frames left out because a viewer was too slow for them")) {}

void ViewerMetrics::count_frame_sent(uint64_t skipped_before) {
  frames_sent_.Increment();
  frames_skipped_.Increment(static_cast<double>(skipped_before));
}

}  // namespace lipofill::server
