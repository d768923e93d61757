#include "server/ops/socket_claim.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;

class SocketClaimTest : public ::testing::Test {
 protected:
  /// A socket on the path, of a program that is no lipofilld.
  int bind_socket() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path_.data(), path_.size());
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(descriptor, 1), 0);
    return descriptor;
  }
  void expect_refused(const std::string& why) {
    const auto claim = SocketClaim::take(path_);
    EXPECT_TRUE(absl::IsFailedPrecondition(claim.status())) << claim.status();
    EXPECT_THAT(std::string(claim.status().message()), HasSubstr(why));
    EXPECT_TRUE(std::filesystem::exists(path_) || why.find("lipofilld") != std::string::npos);
  }

  lipofill::testing::TemporaryDirectory directory_;
  const std::string path_ = directory_.file("socket");
};

TEST_F(SocketClaimTest, OneHasItAsLongAsItLives) {
  {
    const auto first = SocketClaim::take(path_);
    ASSERT_TRUE(first.ok()) << first.status();
    expect_refused("another lipofilld serves there");
  }
  EXPECT_TRUE(SocketClaim::take(path_).ok());
}

TEST_F(SocketClaimTest, WhoeverListensIsLeftAlone) {
  const int other = bind_socket();
  expect_refused("another program serves there");
  ::close(other);
  EXPECT_TRUE(SocketClaim::take(path_).ok()) << "it is dead";
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(SocketClaimTest, AFileThatIsNoSocketIsLeftAlone) {
  std::ofstream(path_) << "a letter";
  expect_refused("no socket");
}

}  // namespace
}  // namespace lipofill::server
