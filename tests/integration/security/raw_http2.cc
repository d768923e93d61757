#include "tests/integration/security/raw_http2.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>

namespace lipofill::testing {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kPreface[] = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
constexpr size_t kFrameHeader = 9;

void put(std::string& bytes, uint32_t value, int n_bytes) {
  for (int shift = 8 * (n_bytes - 1); shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(value >> shift));
}

/// A text with its length before it: an integer with a prefix of 7 bits, no Huffman code.
void put_text(std::string& block, std::string_view text) {
  size_t rest = text.size();
  if (rest < 127) {
    block.push_back(static_cast<char>(rest));
  } else {
    block.push_back(127);
    for (rest -= 127; rest >= 128; rest /= 128) block.push_back(static_cast<char>(rest % 128 + 128));
    block.push_back(static_cast<char>(rest));
  }
  block.append(text);
}

int milliseconds_until(Clock::time_point end) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
  return left > 0 ? static_cast<int>(left) : 0;
}

Clock::time_point after(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

uint32_t number_at(const std::string& bytes, size_t at, int n_bytes) {
  uint32_t value = 0;
  for (int i = 0; i < n_bytes; ++i) value = value << 8 | static_cast<uint8_t>(bytes[at + static_cast<size_t>(i)]);
  return value;
}

}  // namespace

RawHttp2::RawHttp2(int port, uint32_t window) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool connected = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  const int yes = 1;
  ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  ::fcntl(socket_, F_SETFL, O_NONBLOCK);
  std::string settings;
  constexpr uint32_t kInitialWindow = 4;
  put(settings, kInitialWindow, 2);
  put(settings, window, 4);
  if (connected) send(std::string(kPreface) + frame(FrameType::kSettings, 0, 0, settings));
}

RawHttp2::~RawHttp2() {
  ::close(socket_);
}

std::string RawHttp2::frame(FrameType type, uint8_t flags, uint32_t stream, std::string_view payload) {
  std::string bytes;
  put(bytes, static_cast<uint32_t>(payload.size()), 3);
  put(bytes, static_cast<uint32_t>(type), 1);
  put(bytes, flags, 1);
  put(bytes, stream, 4);
  bytes.append(payload);
  return bytes;
}

std::string RawHttp2::call_headers(const std::string& method, const Headers& more) {
  Headers all = {{":method", "POST"},     {":scheme", "http"}, {":path", method},
                 {":authority", "local"}, {"te", "trailers"},  {"content-type", "application/grpc"}};
  all.insert(all.end(), more.begin(), more.end());
  std::string block;
  for (const auto& [name, value] : all) {
    block.push_back(0);
    put_text(block, name);
    put_text(block, value);
  }
  return block;
}

std::string RawHttp2::whole_call(uint32_t stream, const std::string& method, const std::string& message,
                                 const Headers& more) {
  std::string data(1, '\0');
  put(data, static_cast<uint32_t>(message.size()), 4);
  data += message;
  return frame(FrameType::kHeaders, kEndHeaders, stream, call_headers(method, more)) +
         frame(FrameType::kData, kEndStream, stream, data);
}

bool RawHttp2::send(std::string_view bytes, double timeout_s) {
  const auto end = after(timeout_s);
  while (!bytes.empty()) {
    const ssize_t n = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n > 0) {
      bytes.remove_prefix(static_cast<size_t>(n));
      continue;
    }
    if (errno != EAGAIN && errno != EINTR) return false;
    pollfd writable = {socket_, POLLOUT, 0};
    if (::poll(&writable, 1, milliseconds_until(end)) < 1) return false;
  }
  return true;
}

bool RawHttp2::fill(double timeout_s) {
  pollfd readable = {socket_, POLLIN, 0};
  if (::poll(&readable, 1, milliseconds_until(after(timeout_s))) < 1) return false;
  char buffer[65'536];
  const ssize_t n = ::recv(socket_, buffer, sizeof buffer, 0);
  if (n <= 0) return false;
  come_.append(buffer, static_cast<size_t>(n));
  return true;
}

bool RawHttp2::read(SeenFrameHeader& frame, double timeout_s) {
  const auto end = after(timeout_s);
  const auto is_whole = [this] {
    return come_.size() >= kFrameHeader && come_.size() >= kFrameHeader + number_at(come_, 0, 3);
  };
  while (!is_whole()) {
    if (!fill(1e-3 * milliseconds_until(end))) return false;
  }
  const size_t size = number_at(come_, 0, 3);
  frame.type = static_cast<FrameType>(come_[3]);
  frame.flags = static_cast<uint8_t>(come_[4]);
  frame.stream = number_at(come_, 5, 4);
  frame.payload = come_.substr(kFrameHeader, size);
  come_.erase(0, kFrameHeader + size);
  return true;
}

std::vector<SeenFrameHeader> RawHttp2::read_all(double patience_s) {
  std::vector<SeenFrameHeader> frames;
  for (SeenFrameHeader frame; read(frame, patience_s);) frames.push_back(frame);
  return frames;
}

bool RawHttp2::skim() {
  while (true) {
    pollfd readable = {socket_, POLLIN, 0};
    if (::poll(&readable, 1, 0) == 0) return true;
    if (!fill(0.0)) return false;
    come_.clear();
  }
}

}  // namespace lipofill::testing
