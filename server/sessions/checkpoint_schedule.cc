#include "server/sessions/checkpoint_schedule.h"

#include <algorithm>

namespace lipofill::server {
namespace {

/// Automatic checkpoints are as far apart as so many of them take.
constexpr int kLeastSpacing = 100;
constexpr int kLeastSpacingSoon = 10;
constexpr std::chrono::milliseconds kFirstSoon{250};

}  // namespace

CheckpointSchedule::Clock::duration CheckpointSchedule::interval() const {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(interval_s_));
}

void CheckpointSchedule::begin(Time now) {
  if (!due_) due_ = now + interval();
}

void CheckpointSchedule::begin_soon(Time now) {
  soon_ = std::min<Clock::duration>(interval(), kFirstSoon);
  due_ = now + *soon_;
}

void CheckpointSchedule::begin_next(Time began, Time ended) {
  if (soon_) {
    *soon_ *= 2;
    if (*soon_ >= interval()) soon_.reset();
  }
  const int spacing = soon_ ? kLeastSpacingSoon : kLeastSpacing;
  due_ = ended + std::max(soon_.value_or(interval()), spacing * (ended - began));
}

}  // namespace lipofill::server
