#include "server/door/passage.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>

namespace lipofill::server {
namespace {

struct Pair {
  Pair() {
    int ends[2];
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    near = Descriptor(ends[0]);
    far = Descriptor(ends[1]);
  }
  Descriptor near;
  Descriptor far;
};

/// A passage without a meter, a caller at one end and gRPC at the other.
class PassageTest : public ::testing::Test {
 protected:
  PassageTest()
      : caller_(std::move(outside_.far)),
        grpc_(std::move(inside_.far)),
        passage_(std::move(outside_.near), std::move(inside_.near), nullptr) {}

  void move(int times = 1) {
    for (int i = 0; i < times; ++i) passage_.move(Passage::Clock::now());
  }
  static std::string read(const Descriptor& socket) {
    std::string all;
    std::array<char, 65'536> some;
    for (ssize_t n = 0; (n = ::recv(socket.get(), some.data(), some.size(), 0)) > 0;) all.append(some.data(), n);
    return all;
  }
  static size_t fill(const Descriptor& socket) {
    const std::string block(4096, 'y');
    size_t written = 0;
    for (ssize_t n = 0; (n = ::send(socket.get(), block.data(), block.size(), MSG_NOSIGNAL)) > 0;) written += n;
    return written;
  }

  Pair outside_;
  Pair inside_;
  Descriptor caller_;
  Descriptor grpc_;
  Passage passage_;
};

TEST_F(PassageTest, BytesGoBothWays) {
  ::send(caller_.get(), "question", 8, 0);
  move();
  EXPECT_EQ(read(grpc_), "question");
  ::send(grpc_.get(), "answer", 6, 0);
  move();
  EXPECT_EQ(read(caller_), "answer");
  EXPECT_FALSE(passage_.is_over());
}

TEST_F(PassageTest, WhoDoesNotReadHoldsBackTheOther) {
  size_t sent = 0;
  for (int i = 0; i < 50; ++i) {
    sent += fill(grpc_);
    move();
  }
  EXPECT_EQ(fill(grpc_), 0u) << "there is no room without an end";
  EXPECT_EQ(passage_.inner_events() & 1u, 0u);
  std::string got;
  for (int i = 0; i < 50; ++i) {
    got += read(caller_);
    move();
  }
  EXPECT_EQ(got.size(), sent);
}

TEST_F(PassageTest, WhatWasSentBeforeTheEndArrives) {
  ::send(grpc_.get(), "last words", 10, 0);
  grpc_.close();
  move(2);
  EXPECT_EQ(read(caller_), "last words");
  EXPECT_TRUE(passage_.is_over());
}

TEST_F(PassageTest, GrpcLearnsThatTheCallerHasLeft) {
  ::send(caller_.get(), "question", 8, 0);
  caller_.close();
  move(3);
  EXPECT_EQ(read(grpc_), "question");
  char byte = 0;
  EXPECT_EQ(::recv(grpc_.get(), &byte, 1, 0), 0);
}

}  // namespace
}  // namespace lipofill::server
