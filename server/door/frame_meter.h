#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/door/token_bucket.h"

namespace lipofill::server {

/// The allowances say what all connections together may do beyond the share that each has of its
/// own. What gRPC keeps of a stream that was reset is gone once it got round to it: measured, it
/// grows with the backlog alone, and 2,000 a second leave none.
struct SharedAllowances {
  TokenBucket streams{2000.0, 2000.0};
  TokenBucket resets{200.0, 1000.0};
};

/// Meters what a client sends on one HTTP/2 connection (RFC 9113) by the heads of its frames; it
/// reads no headers and no messages.
///
/// gRPC 1.51 bounds streams that are open, and not those that were opened and reset; nor the frames
/// that a block of headers goes on in. Frames that cost it more than they cost their sender have a
/// rate, and wait where they come faster. What no client of gRPC sends ends the connection.
/// Checked by tests/unit/server/door/frame_meter_test.cc.
class FrameMeter {
 public:
  using Clock = TokenBucket::Clock;

  /// Bytes of a block of headers, over all of its frames; the daemon takes as much of them decoded.
  static constexpr size_t kMostHeaderBytes = 64 << 10;
  static constexpr int kMostContinuations = 16;
  static constexpr size_t kFrameHead = 9;

  struct Verdict {
    size_t pass = 0;                             ///< so many of the bytes may go on
    std::optional<Clock::time_point> wait = {};  ///< the next may go on then, no earlier
    std::string hostile = {};                    ///< the reason to end the connection; empty: none
  };

  explicit FrameMeter(SharedAllowances& shared) : shared_(shared) {}

  /// Looks at the bytes that have come and have not gone on; those that `pass` are not to be shown
  /// again. A frame's head goes on whole.
  Verdict look(std::string_view bytes, Clock::time_point now);

 private:
  struct Head {
    size_t size = 0;
    uint8_t type = 0;
    uint8_t flags = 0;
  };
  static Head read_head(const char* bytes);
  bool fits_preface(std::string_view bytes);
  std::string check_block(const Head& head);
  /// The moment when the frame may go on, where that is not now.
  std::optional<Clock::time_point> hold(const Head& head, Clock::time_point now);
  static std::optional<Clock::time_point> take(TokenBucket& own, TokenBucket* shared, Clock::time_point now);

  SharedAllowances& shared_;
  TokenBucket streams_{100.0, 400.0};
  TokenBucket resets_{20.0, 200.0};
  /// Settings, pings, window updates, and messages in small pieces.
  TokenBucket small_frames_{20'000.0, 40'000.0};
  TokenBucket settings_{10.0, 50.0};
  size_t preface_seen_ = 0;
  size_t payload_left_ = 0;
  bool is_in_block_ = false;  ///< a block of headers goes on in the next frame
  size_t block_bytes_ = 0;
  int continuations_ = 0;
};

}  // namespace lipofill::server
