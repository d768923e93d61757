#include "server/door/frame_meter.h"

#include <algorithm>

namespace lipofill::server {
namespace {

constexpr std::string_view kPreface = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";

constexpr uint8_t kData = 0;
constexpr uint8_t kHeaders = 1;
constexpr uint8_t kResetStream = 3;
constexpr uint8_t kSettings = 4;
constexpr uint8_t kContinuation = 9;
constexpr uint8_t kEndHeaders = 4;

/// Messages in pieces below this count as small frames.
constexpr size_t kSmall = 256;

uint8_t byte_at(const char* bytes, int at) {
  return static_cast<uint8_t>(bytes[at]);
}

}  // namespace

FrameMeter::Head FrameMeter::read_head(const char* bytes) {
  const size_t size = size_t{byte_at(bytes, 0)} << 16 | size_t{byte_at(bytes, 1)} << 8 | byte_at(bytes, 2);
  return {size, byte_at(bytes, 3), byte_at(bytes, 4)};
}

bool FrameMeter::fits_preface(std::string_view bytes) {
  const bool fits = kPreface.substr(preface_seen_, bytes.size()) == bytes;
  preface_seen_ += bytes.size();
  return fits;
}

FrameMeter::Verdict FrameMeter::look(std::string_view bytes, Clock::time_point now) {
  Verdict verdict;
  while (verdict.pass < bytes.size()) {
    const std::string_view rest = bytes.substr(verdict.pass);
    if (preface_seen_ < kPreface.size()) {
      const size_t n = std::min(rest.size(), kPreface.size() - preface_seen_);
      if (!fits_preface(rest.substr(0, n))) {
        verdict.hostile = "does not begin as HTTP/2 does";
        return verdict;
      }
      verdict.pass += n;
    } else if (payload_left_ > 0) {
      const size_t n = std::min(rest.size(), payload_left_);
      payload_left_ -= n;
      verdict.pass += n;
    } else {
      if (rest.size() < kFrameHead) break;
      const Head head = read_head(rest.data());
      verdict.wait = hold(head, now);
      if (verdict.wait) break;
      verdict.hostile = check_block(head);
      if (!verdict.hostile.empty()) break;
      payload_left_ = head.size;
      verdict.pass += kFrameHead;
    }
  }
  return verdict;
}

std::string FrameMeter::check_block(const Head& head) {
  if (is_in_block_ != (head.type == kContinuation)) return "goes on in the wrong frame within its headers";
  if (head.type != kHeaders && head.type != kContinuation) return "";
  if (head.type == kHeaders) {
    block_bytes_ = 0;
    continuations_ = 0;
  } else {
    ++continuations_;
  }
  block_bytes_ += head.size;
  is_in_block_ = (head.flags & kEndHeaders) == 0;
  const bool is_small = block_bytes_ <= kMostHeaderBytes && continuations_ <= kMostContinuations;
  return is_small ? "" : "sends headers without an end";
}

std::optional<FrameMeter::Clock::time_point> FrameMeter::take(TokenBucket& own, TokenBucket* shared,
                                                              Clock::time_point now) {
  if (own.take(now) || (shared != nullptr && shared->take(now))) return std::nullopt;
  const Clock::time_point next = own.next(now);
  return shared != nullptr ? std::min(next, shared->next(now)) : next;
}

std::optional<FrameMeter::Clock::time_point> FrameMeter::hold(const Head& head, Clock::time_point now) {
  switch (head.type) {
    case kHeaders:
      return take(streams_, &shared_.streams, now);
    case kResetStream:
      return take(resets_, &shared_.resets, now);
    case kSettings:
      return take(settings_, nullptr, now);
    case kContinuation:
      return std::nullopt;  // so many in a block
    case kData:
      if (head.size >= kSmall) return std::nullopt;
      break;
    default:
      break;
  }
  return take(small_frames_, nullptr, now);
}

}  // namespace lipofill::server
