#include "server/sessions/checkpoint_schedule.h"

#include <algorithm>

namespace lipofill::server {
namespace {

/// Automatic checkpoints are as far apart as so many of them take.
constexpr int kLeastSpacing = 100;

}  // namespace

CheckpointSchedule::Clock::duration CheckpointSchedule::interval() const {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(interval_s_));
}

void CheckpointSchedule::begin(Time now) {
  if (!due_) due_ = now + interval();
}

void CheckpointSchedule::begin_next(Time began, Time ended) {
  due_ = ended + std::max(interval(), kLeastSpacing * (ended - began));
}

}  // namespace lipofill::server
