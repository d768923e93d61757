#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lipofill::testing {

/// Types of HTTP/2 frames (RFC 9113, section 6).
enum class FrameType : uint8_t {
  kData = 0,
  kHeaders = 1,
  kResetStream = 3,
  kSettings = 4,
  kPing = 6,
  kGoAway = 7,
  kWindowUpdate = 8,
  kContinuation = 9,
};

/// A frame as it came.
struct SeenFrameHeader {
  FrameType type = FrameType::kData;
  uint8_t flags = 0;
  uint32_t stream = 0;
  std::string payload;
};

/// A client that writes HTTP/2 frames by hand on a plain connection of its own, for what no library
/// would send. Header blocks are literals without compression (RFC 7541, section 6.2.2).
class RawHttp2 {
 public:
  using Headers = std::vector<std::pair<std::string, std::string>>;
  static constexpr uint8_t kEndStream = 1;
  static constexpr uint8_t kEndHeaders = 4;

  /// Connects to a port of 127.0.0.1, and says how much of each answer it has room for.
  explicit RawHttp2(int port, uint32_t window = 65'535);
  ~RawHttp2();
  RawHttp2(const RawHttp2&) = delete;
  RawHttp2& operator=(const RawHttp2&) = delete;

  /// A frame's bytes.
  static std::string frame(FrameType type, uint8_t flags, uint32_t stream, std::string_view payload);
  /// The headers of a gRPC call, as one block.
  static std::string call_headers(const std::string& method, const Headers& more = {});
  /// HEADERS and a DATA frame with one message: a whole call.
  static std::string whole_call(uint32_t stream, const std::string& method, const std::string& message,
                                const Headers& more = {});

  /// Writes bytes, waiting for so long in all while the peer does not take them. False once the
  /// connection has ended or the time is over.
  bool send(std::string_view bytes, double timeout_s = 10.0);
  /// The next frame; false when none comes within the time or the connection has ended.
  bool read(SeenFrameHeader& frame, double timeout_s = 10.0);
  /// The frames that come, for so long as there is one within the time.
  std::vector<SeenFrameHeader> read_all(double patience_s);
  /// Reads and forgets what has come; false once the connection has ended.
  bool skim();

 private:
  bool fill(double timeout_s);

  int socket_ = -1;
  std::string come_;
};

}  // namespace lipofill::testing
