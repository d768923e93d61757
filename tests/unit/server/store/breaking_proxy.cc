#include "tests/unit/server/store/breaking_proxy.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <string_view>
#include <vector>

namespace lipofill::testing {
namespace {

constexpr int kPollMs = 20;

sockaddr_un socket_in(const std::string& directory) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string path = directory + "/.s.PGSQL.5432";
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  return address;
}

bool has_bytes(int socket) {
  pollfd waits{socket, POLLIN, 0};
  return ::poll(&waits, 1, kPollMs) > 0;
}

bool write_all(int socket, std::string_view bytes) {
  return ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
}

}  // namespace

BreakingProxy::BreakingProxy(const std::string& directory, const std::string& server_directory)
    : server_socket_(server_directory), listening_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
  const sockaddr_un address = socket_in(directory);
  EXPECT_EQ(::bind(listening_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(::listen(listening_, 8), 0);
  thread_ = std::thread([this] { serve(); });
}

BreakingProxy::~BreakingProxy() {
  ends_ = true;
  thread_.join();
  ::close(listening_);
}

void BreakingProxy::serve() {
  std::vector<std::thread> connections;
  while (!ends_) {
    if (!has_bytes(listening_)) continue;
    const int client = ::accept(listening_, nullptr, nullptr);
    const int server = ::socket(AF_UNIX, SOCK_STREAM, 0);
    const sockaddr_un address = socket_in(server_socket_);
    EXPECT_EQ(::connect(server, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    connections.emplace_back([this, client, server] { pass_on(client, server); });
  }
  for (std::thread& connection : connections) connection.join();
}

void BreakingProxy::pass_on(int client, int server) {
  std::array<char, 65536> bytes{};
  for (bool goes_on = true; goes_on && !ends_;) {
    pollfd both[] = {{client, POLLIN, 0}, {server, POLLIN, 0}};
    ::poll(both, 2, kPollMs);
    for (const auto& [from, to] : {std::pair(both[0], server), std::pair(both[1], client)}) {
      if (from.revents == 0 || !goes_on) continue;
      const ssize_t n = ::recv(from.fd, bytes.data(), bytes.size(), 0);
      if (n <= 0) goes_on = false;
      if (!goes_on) break;
      const std::string_view piece(bytes.data(), static_cast<size_t>(n));
      const bool is_commit = from.fd == client && piece.find("COMMIT") != std::string_view::npos;
      const Loss loses = is_commit ? loses_.exchange(kNothing) : kNothing;
      if (loses != kCommit) goes_on = write_all(to, piece);
      if (loses == kAnswer) ::recv(server, bytes.data(), bytes.size(), 0);
      if (loses != kNothing) goes_on = false;
    }
  }
  ::close(client);
  ::close(server);
}

}  // namespace lipofill::testing
