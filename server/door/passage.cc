#include "server/door/passage.h"

#include <sys/epoll.h>
#include <sys/socket.h>

namespace lipofill::server {

Passage::Passage(Descriptor outer, Descriptor inner, std::unique_ptr<FrameMeter> meter)
    : outer_(std::move(outer)), inner_(std::move(inner)), meter_(std::move(meter)) {}

void Passage::move(Clock::time_point now) {
  move_down();
  if (!is_over()) move_up(now);
}

// What has passed the meter and does not fit into gRPC's socket yet is not shown to it again.
size_t Passage::allowed(Clock::time_point now) {
  wait_.reset();
  if (meter_ == nullptr) return up_.waiting().size();
  FrameMeter::Verdict verdict = meter_->look(up_.waiting().substr(passed_), now);
  passed_ += verdict.pass;
  wait_ = verdict.wait;
  hostile_ = std::move(verdict.hostile);
  return passed_;
}

void Passage::move_up(Clock::time_point now) {
  if (!up_.read_from(outer_.get())) {
    is_broken_ = true;
    return;
  }
  has_begun_ = has_begun_ || !up_.waiting().empty();
  const size_t most = allowed(now);
  const size_t before = up_.waiting().size();
  is_broken_ = !up_.write_to(inner_.get(), most);
  if (meter_ != nullptr) passed_ -= before - up_.waiting().size();
  // A frame that is not whole when its sender has ended never will be.
  const bool is_all_gone = up_.waiting().empty() || (!wait_ && passed_ == 0 && meter_ != nullptr);
  if (up_.has_ended() && is_all_gone && !up_closed_) {
    ::shutdown(inner_.get(), SHUT_WR);
    up_closed_ = true;
  }
}

void Passage::move_down() {
  if (!down_.read_from(inner_.get()) || !down_.write_to(outer_.get(), down_.waiting().size())) is_broken_ = true;
  left_ = down_.is_done();
}

uint32_t Passage::outer_events() const {
  const bool reads = up_.has_room() && !wait_;
  const bool writes = !down_.waiting().empty();
  return (reads ? EPOLLIN : 0u) | (writes ? EPOLLOUT : 0u);
}

uint32_t Passage::inner_events() const {
  const bool reads = down_.has_room();
  const bool writes = meter_ != nullptr ? passed_ > 0 : !up_.waiting().empty();
  return (reads ? EPOLLIN : 0u) | (writes ? EPOLLOUT : 0u);
}

}  // namespace lipofill::server
