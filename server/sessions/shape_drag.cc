#include "server/sessions/shape_drag.h"

#include <exception>
#include <new>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/sessions/draining.h"
#include "server/sessions/memory_reserve.h"

namespace lipofill::server {
namespace {

double seconds_since(ShapeDrag::Clock::time_point begin) {
  return std::chrono::duration<double>(ShapeDrag::Clock::now() - begin).count();
}

/// Nothing that goes wrong with a shape may reach others, or cost a caller an answer.
template <typename Work>
absl::Status guard_shape(Work&& work) {
  try {
    const MayFail may_fail;
    return work();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("out of memory while the shape was found");
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("the shape was not found: ", error.what()));
  }
}

}  // namespace

ShapeDrag::~ShapeDrag() {
  if (waiting_) waiting_->reply(draining(), nullptr);
}

void ShapeDrag::ask(ShapeRequest request) {
  std::optional<ShapeRequest> older;
  bool is_new = false;
  {
    const std::lock_guard lock(mutex_);
    older = std::exchange(waiting_, std::move(request));
    superseded_ += older.has_value();
    is_new = !std::exchange(is_scheduled_, true);
  }
  if (older) older->reply(absl::AbortedError("a newer request of the same drag took its place"), nullptr);
  if (is_new) workers_.schedule_at_once(shared_from_this(), tenant_);
}

ShapeDrag::Clock::duration ShapeDrag::idle_time() const {
  const std::lock_guard lock(mutex_);
  return is_scheduled_ ? Clock::duration::zero() : Clock::now() - last_use_;
}

WorkerPool::Next ShapeDrag::take_turn() {
  std::optional<ShapeRequest> request;
  {
    const std::lock_guard lock(mutex_);
    request = std::exchange(waiting_, std::nullopt);
  }
  if (request) answer(*request);
  const std::lock_guard lock(mutex_);
  last_use_ = Clock::now();
  if (waiting_) return {WorkerPool::Next::kAgain, {}};
  is_scheduled_ = false;
  return {};
}

void ShapeDrag::answer(const ShapeRequest& request) {
  const Clock::time_point begin = Clock::now();
  double preparing_s = 0.0;
  absl::Status done = guard_shape([&]() -> absl::Status {
    if (absl::Status wanted = check_wanted(request.unwanted); !wanted.ok()) return wanted;
    if (absl::Status prepared = prepare(request); !prepared.ok()) return prepared;
    preparing_s = seconds_since(begin);
    return shape_->find(request.volumes, request.from_last);
  });
  if (!done.ok()) return request.reply(done, nullptr);
  uint64_t superseded = 0;
  {
    const std::lock_guard lock(mutex_);
    superseded = superseded_;
  }
  const FoundTrial found{*shape_, preparing_s, seconds_since(begin) - preparing_s, superseded};
  request.reply(absl::OkStatus(), &found);
}

/// Makes the equations of the request's plan, unless they are those at hand.
absl::Status ShapeDrag::prepare(const ShapeRequest& request) {
  if (shape_ != nullptr && plan_ == request.plan) return absl::OkStatus();
  shape_ = nullptr;
  place_.unclaim();
  auto made = request.make();
  if (!made.ok()) return made.status();
  if (absl::Status room = place_.claim((*made)->shape().memory_bytes()); !room.ok()) return room;
  shape_ = *std::move(made);
  plan_ = request.plan;
  return absl::OkStatus();
}

}  // namespace lipofill::server
