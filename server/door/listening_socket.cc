#include "server/door/listening_socket.h"

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace {

constexpr int kType = SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK;

absl::Status cannot(const std::string& address, const char* hint) {
  return absl::UnavailableError(absl::StrCat("cannot listen on ", address, hint, " (", std::strerror(errno), ")"));
}

int port_of(const sockaddr_storage& address) {
  return ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                                             : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

/// Binds one address of a host; the number of the port goes to `port`, where that was 0.
absl::StatusOr<Descriptor> listen_on_address(const addrinfo& found, const std::string& name, int& port) {
  sockaddr_storage address{};
  std::memcpy(&address, found.ai_addr, found.ai_addrlen);
  (address.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(address).sin6_port
                                 : reinterpret_cast<sockaddr_in&>(address).sin_port) =
      htons(static_cast<uint16_t>(port));
  Descriptor socket(::socket(found.ai_family, kType, 0));
  const int yes = 1;
  // Not SO_REUSEPORT: two daemons would share a port and nobody would notice.
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const bool listens = socket.is_open() &&
                       ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), found.ai_addrlen) == 0 &&
                       ::listen(socket.get(), SOMAXCONN) == 0;
  if (!listens) return cannot(name, ": is the port taken?");
  socklen_t size = sizeof address;
  ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  port = port_of(address);
  return socket;
}

}  // namespace

absl::StatusOr<std::vector<ListeningSocket>> listen_on(const std::string& host, int port) {
  const std::string name = absl::StrCat(host, ":", port);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE;
  addrinfo* list = nullptr;
  if (const int error = ::getaddrinfo(host.c_str(), nullptr, &hints, &list); error != 0) {
    return absl::UnavailableError(absl::StrCat("cannot listen on ", name, ": ", ::gai_strerror(error)));
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> held(list, &::freeaddrinfo);
  std::vector<ListeningSocket> sockets;
  absl::Status failed;
  for (const addrinfo* found = list; found != nullptr; found = found->ai_next) {
    auto socket = listen_on_address(*found, name, port);
    if (socket.ok()) {
      sockets.push_back({*std::move(socket), "", port});
    } else if (errno != EAFNOSUPPORT && errno != EADDRNOTAVAIL) {
      return socket.status();
    } else {
      failed = socket.status();  // of two families that a name has, the machine may have one
    }
  }
  if (sockets.empty()) return failed;
  return sockets;
}

absl::StatusOr<std::vector<ListeningSocket>> listen_on_path(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return absl::UnavailableError(absl::StrCat(path, " is too long"));
  std::memcpy(address.sun_path, path.data(), path.size());
  struct stat there {};
  if (::lstat(path.c_str(), &there) == 0 && S_ISSOCK(there.st_mode)) ::unlink(path.c_str());
  Descriptor socket(::socket(AF_UNIX, kType, 0));
  const bool listens = socket.is_open() &&
                       ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
                       ::chmod(path.c_str(), 0660) == 0 && ::listen(socket.get(), SOMAXCONN) == 0;
  if (!listens) return cannot(absl::StrCat("unix:", path), ": may this user make files in its directory?");
  std::vector<ListeningSocket> sockets;
  sockets.push_back({std::move(socket), path, 0});
  return sockets;
}

}  // namespace lipofill::server
