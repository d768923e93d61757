#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/door/descriptor.h"
#include "server/door/frame_meter.h"
#include "server/door/lane.h"

namespace lipofill::server {

/// One connection that came through the door: passes bytes on between the caller's socket and the
/// inner one, whose other end gRPC has. What the caller sends passes a FrameMeter, except where it
/// is encrypted. Either side's end becomes the other's, after what it had sent before. Checked by
/// tests/unit/server/door/passage_test.cc.
class Passage {
 public:
  using Clock = FrameMeter::Clock;

  /// @param meter  nullptr for what is encrypted
  Passage(Descriptor outer, Descriptor inner, std::unique_ptr<FrameMeter> meter);

  int outer() const { return outer_.get(); }
  int inner() const { return inner_.get(); }

  /// Passes on what can be passed on without waiting.
  void move(Clock::time_point now);
  /// True when there is nothing more to pass on: to be closed.
  bool is_over() const { return is_broken_ || !hostile_.empty() || (up_.is_done() && down_.is_done()) || left_; }
  /// Tells what the caller did that no client does; empty for nothing.
  const std::string& hostile() const { return hostile_; }
  /// The moment to move again, where frames wait for their rate.
  const std::optional<Clock::time_point>& wait() const { return wait_; }
  /// True once the caller has sent what a connection begins with.
  bool has_begun() const { return has_begun_; }

  /// Tells what is to be waited for at each socket: EPOLLIN, EPOLLOUT.
  uint32_t outer_events() const;
  uint32_t inner_events() const;

 private:
  size_t allowed(Clock::time_point now);
  void move_up(Clock::time_point now);
  void move_down();

  Descriptor outer_;
  Descriptor inner_;
  const std::unique_ptr<FrameMeter> meter_;
  Lane up_;            ///< from the caller to gRPC
  Lane down_;          ///< from gRPC to the caller
  size_t passed_ = 0;  ///< of what waits in up_, these have passed the meter
  std::optional<Clock::time_point> wait_;
  std::string hostile_;
  bool has_begun_ = false;
  bool is_broken_ = false;
  bool left_ = false;       ///< gRPC has ended the connection, and all that it sent has gone
  bool up_closed_ = false;  ///< gRPC has been told that the caller sends no more
};

}  // namespace lipofill::server
