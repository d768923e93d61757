#include "server/door/door.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <condition_variable>
#include <cstddef>
#include <mutex>

#include "server/door/knock.h"
#include "server/door/peer_socket.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using std::chrono::milliseconds;
using testing::TemporaryDirectory;

/// A door before somebody who takes connections and holds them.
class DoorTest : public ::testing::Test {
 protected:
  void open(DoorBounds bounds = {}) {
    door_ = std::make_unique<Door>(bounds);
    auto sockets = listen_on("127.0.0.1", 0);
    ASSERT_TRUE(sockets.ok()) << sockets.status();
    own_ = own_address(sockets->front());
    door_->add(std::move(sockets->front()), false);
    ASSERT_TRUE(door_->open([this](int socket, size_t) { take(socket); }).ok());
  }
  void take(int socket) {
    const std::lock_guard lock(mutex_);
    taken_.emplace_back(socket);
    changed_.notify_all();
  }
  Descriptor call() const {
    Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(::connect(socket.get(), reinterpret_cast<const sockaddr*>(&own_.address), own_.size), 0);
    return socket;
  }
  /// True once so many were taken.
  bool await_taken(size_t n) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(10), [&] { return taken_.size() >= n; });
  }
  /// True when the door ends the connection.
  static bool is_ended(const Descriptor& socket) {
    const timeval patience{10, 0};
    ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    char byte = 0;
    return ::recv(socket.get(), &byte, 1, 0) == 0;
  }
  uint64_t turned_away(TurnedAway why) const { return door_->figures().turned_away[static_cast<size_t>(why)]; }

  std::unique_ptr<Door> door_;
  OwnAddress own_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Descriptor> taken_;
};

TEST_F(DoorTest, LetsInAsManyAsThereMayBe) {
  open({.connections = 2});
  const Descriptor first = call();
  Descriptor second = call();
  ASSERT_TRUE(await_taken(2));
  EXPECT_TRUE(is_ended(call()));
  EXPECT_EQ(turned_away(TurnedAway::kFull), 1u);
  second.close();
  while (door_->figures().open > 1) std::this_thread::sleep_for(milliseconds(1));
  const Descriptor third = call();
  EXPECT_TRUE(await_taken(3));
}

TEST_F(DoorTest, EndsWhatSaysNothingOrIsNoHttp2) {
  open({.to_begin = std::chrono::seconds(1)});
  const Descriptor silent = call();
  const Descriptor other = call();
  ::send(other.get(), "GET / HTTP/1.1\r\n\r\n", 18, MSG_NOSIGNAL);
  EXPECT_TRUE(is_ended(other));
  EXPECT_TRUE(is_ended(silent));
  EXPECT_EQ(turned_away(TurnedAway::kHostile), 1u);
  EXPECT_EQ(turned_away(TurnedAway::kSilent), 1u);
}

TEST_F(DoorTest, TellsWhoIsOnAUnixSocket) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("socket");
  auto sockets = listen_on_path(path);
  ASSERT_TRUE(sockets.ok()) << sockets.status();
  struct stat found {};
  EXPECT_EQ(::lstat(path.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777u, 0660u);
  const auto pair = make_inner_pair("unix", 7);
  ASSERT_TRUE(pair);
  sockaddr_un peer{};
  socklen_t size = sizeof peer;
  ASSERT_EQ(::getpeername(pair->grpcs.get(), reinterpret_cast<sockaddr*>(&peer), &size), 0);
  const std::string name(peer.sun_path + 1, size - offsetof(sockaddr_un, sun_path) - 1);
  EXPECT_EQ("unix-abstract:" + name.substr(0, 14), kUnixCallers);
}

TEST_F(DoorTest, APortThatIsTakenIsToldSo) {
  auto first = listen_on("127.0.0.1", 0);
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(listen_on("127.0.0.1", first->front().port).status().code(), absl::StatusCode::kUnavailable);
}

TEST(CountedAddress, IsOfTheNetworkOnly) {
  sockaddr_storage peer{};
  auto& four = reinterpret_cast<sockaddr_in&>(peer);
  four.sin_family = AF_INET;
  four.sin_addr.s_addr = htonl(0x7f000001);
  EXPECT_EQ(counted_address(peer), "");
  four.sin_addr.s_addr = htonl(0x0a000001);
  EXPECT_EQ(counted_address(peer), "10.0.0.1");
  auto& six = reinterpret_cast<sockaddr_in6&>(peer);
  six.sin6_family = AF_INET6;
  ::inet_pton(AF_INET6, "2001:db8::1:2:3", &six.sin6_addr);
  EXPECT_EQ(counted_address(peer), "2001:db8::") << "a network is one peer";
  ::inet_pton(AF_INET6, "::ffff:127.0.0.1", &six.sin6_addr);
  EXPECT_EQ(counted_address(peer), "");
}

}  // namespace
}  // namespace lipofill::server
