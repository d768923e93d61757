#include "server/door/knock.h"

#include <netinet/in.h>
#include <poll.h>

#include <cerrno>
#include <cstring>
#include <string_view>

#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace {

/// This is what an HTTP/2 connection begins with, and empty SETTINGS.
constexpr std::string_view kHello("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0", 33);

absl::Status failed(const char* what) {
  return absl::UnavailableError(absl::StrCat(what, ": ", std::strerror(errno)));
}

bool comes(int socket, short event, std::chrono::milliseconds timeout) {
  pollfd polled = {socket, event, 0};
  return ::poll(&polled, 1, static_cast<int>(timeout.count())) == 1;
}

}  // namespace

OwnAddress own_address(const ListeningSocket& socket) {
  OwnAddress own;
  own.size = sizeof own.address;
  ::getsockname(socket.socket.get(), reinterpret_cast<sockaddr*>(&own.address), &own.size);
  if (own.address.ss_family == AF_INET) {
    in_addr& address = reinterpret_cast<sockaddr_in&>(own.address).sin_addr;
    if (address.s_addr == htonl(INADDR_ANY)) address.s_addr = htonl(INADDR_LOOPBACK);
  } else if (own.address.ss_family == AF_INET6) {
    in6_addr& address = reinterpret_cast<sockaddr_in6&>(own.address).sin6_addr;
    if (IN6_IS_ADDR_UNSPECIFIED(&address)) address = in6addr_loopback;
  }
  return own;
}

absl::Status knock(const OwnAddress& at, bool expects_answer, std::chrono::milliseconds timeout) {
  const Descriptor socket(::socket(at.address.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket.is_open()) return failed("no socket can be opened");
  const int connected = ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&at.address), at.size);
  if (connected != 0 && errno != EINPROGRESS) return failed("its own address does not take a connection");
  if (!comes(socket.get(), POLLOUT, timeout)) return absl::UnavailableError("a connection to it is not accepted");
  if (!expects_answer) return absl::OkStatus();
  if (::send(socket.get(), kHello.data(), kHello.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(kHello.size())) {
    return failed("a connection to it breaks");
  }
  if (!comes(socket.get(), POLLIN, timeout)) return absl::UnavailableError("a connection to it is not answered");
  char byte = 0;
  const ssize_t n = ::recv(socket.get(), &byte, 1, 0);
  if (n < 0) return failed("a connection to it breaks");
  return n == 1 ? absl::OkStatus() : absl::UnavailableError("it closes a connection to it unanswered");
}

}  // namespace lipofill::server
