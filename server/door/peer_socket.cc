#include "server/door/peer_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>

#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace {

bool is_loopback(const in6_addr& address) {
  const bool is_mapped = IN6_IS_ADDR_V4MAPPED(&address);
  return IN6_IS_ADDR_LOOPBACK(&address) || (is_mapped && address.s6_addr[12] == 127);
}

/// Names an end of the pair in the namespace that has no files.
bool name_socket(int socket, const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path + 1, name.data(), name.size());
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return ::bind(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0;
}

}  // namespace

std::string counted_address(const sockaddr_storage& peer) {
  char text[INET6_ADDRSTRLEN] = "";
  if (peer.ss_family == AF_INET) {
    const in_addr& address = reinterpret_cast<const sockaddr_in&>(peer).sin_addr;
    if ((ntohl(address.s_addr) >> 24) == 127) return "";
    return ::inet_ntop(AF_INET, &address, text, sizeof text);
  }
  if (peer.ss_family != AF_INET6) return "";
  in6_addr address = reinterpret_cast<const sockaddr_in6&>(peer).sin6_addr;
  if (is_loopback(address)) return "";
  // Who has one address of a network of IPv6 has all of its lower half.
  if (!IN6_IS_ADDR_V4MAPPED(&address)) std::memset(address.s6_addr + 8, 0, 8);
  return ::inet_ntop(AF_INET6, &address, text, sizeof text);
}

void set_up_peer_socket(int socket, std::chrono::milliseconds unread) {
  const int yes = 1;
  const auto timeout = static_cast<unsigned int>(unread.count());
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  ::setsockopt(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, &timeout, sizeof timeout);
}

std::optional<InnerPair> make_inner_pair(const std::string& kind, uint64_t id) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0) return std::nullopt;
  InnerPair pair{Descriptor(ends[0]), Descriptor(ends[1])};
  // Without a name gRPC would take it for a UNIX socket of the daemon's own.
  if (!name_socket(ends[0], absl::StrCat("lipofill-", kind, "-", ::getpid(), "-", id))) return std::nullopt;
  return pair;
}

}  // namespace lipofill::server
