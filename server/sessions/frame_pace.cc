#include "server/sessions/frame_pace.h"

#include <cmath>

namespace lipofill::server {

bool FramePace::is_due(double time_s, bool at_rest, Clock::time_point now) const {
  if (!at_rest && now < next_due_) return false;
  // Times are sums of steps: a frame may come a rounding before its due time.
  return time_s >= next_due_s_ - 1e-9 * interval_s_;
}

void FramePace::note_offered(double time_s) {
  if (interval_s_ > 0.0) next_due_s_ = (std::floor(time_s / interval_s_ + 1e-9) + 1.0) * interval_s_;
}

void FramePace::note_taken(Clock::time_point now) {
  if (max_rate_hz_ > 0.0) next_due_ = find_next_due(now);
}

FramePace::Clock::time_point FramePace::find_next_due(Clock::time_point now) const {
  const auto period = std::chrono::ceil<Clock::duration>(std::chrono::duration<double>(1.0 / max_rate_hz_));
  if (!shares_rate_) return now + period;
  return now + period - now.time_since_epoch() % period;
}

}  // namespace lipofill::server
