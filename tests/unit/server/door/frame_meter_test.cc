#include "server/door/frame_meter.h"

#include <gtest/gtest.h>

namespace lipofill::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr char kPreface[] = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
constexpr uint8_t kEndHeaders = 4;

std::string frame(uint8_t type, size_t size, uint8_t flags = 0) {
  std::string bytes;
  for (const int shift : {16, 8, 0}) bytes.push_back(static_cast<char>(size >> shift));
  bytes.push_back(static_cast<char>(type));
  bytes.push_back(static_cast<char>(flags));
  return bytes + std::string(4 + size, 'x');
}

std::string many(const std::string& bytes, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += bytes;
  return all;
}

class FrameMeterTest : public ::testing::Test {
 protected:
  FrameMeterTest() { look(kPreface); }

  FrameMeter::Verdict look(const std::string& bytes, FrameMeter::Clock::duration later = {}) {
    now_ += later;
    return meter_.look(bytes, now_);
  }
  /// How many of so many frames pass now, and each second after it.
  std::pair<int, int> rate_of(const std::string& bytes, int times) {
    const auto size = static_cast<int>(bytes.size());
    const int at_once = static_cast<int>(look(many(bytes, times)).pass) / size;
    const int later = static_cast<int>(look(many(bytes, times), seconds(1)).pass) / size;
    return {at_once, later};
  }

  SharedAllowances shared_;
  FrameMeter meter_{shared_};
  FrameMeter::Clock::time_point now_{seconds(1000)};
};

TEST_F(FrameMeterTest, WhatClientsDoPasses) {
  std::string usual = frame(4, 30) + frame(8, 4);
  for (int call = 0; call < 200; ++call) usual += frame(1, 90, kEndHeaders) + frame(0, 40);
  usual += frame(0, 16'384) + frame(0, 1 << 20) + frame(6, 8) + frame(3, 4);
  const auto verdict = look(usual);
  EXPECT_EQ(verdict.pass, usual.size());
  EXPECT_FALSE(verdict.wait);
  EXPECT_EQ(verdict.hostile, "");
}

TEST_F(FrameMeterTest, BytesMayComeInAnyPieces) {
  const std::string bytes = frame(4, 6) + frame(1, 90, kEndHeaders) + frame(0, 300);
  std::string held;
  size_t passed = 0;
  for (const char byte : bytes) {
    held.push_back(byte);
    const size_t pass = look(held).pass;
    EXPECT_LT(held.size() - pass, FrameMeter::kFrameHead);
    held.erase(0, pass);
    passed += pass;
  }
  EXPECT_EQ(passed, bytes.size());
}

TEST_F(FrameMeterTest, WhatIsNoHttp2IsHostile) {
  FrameMeter other(shared_);
  EXPECT_NE(other.look("GET / HTTP/1.1\r\n", now_).hostile, "");
}

TEST_F(FrameMeterTest, StreamsThatAreOpenedAndResetHaveARate) {
  const auto [at_once, later] = rate_of(frame(1, 20, kEndHeaders) + frame(3, 4), 100'000);
  EXPECT_EQ(at_once, 1200) << "resets: 200 of its own, 1,000 of all";
  EXPECT_EQ(later, 220);
}

TEST_F(FrameMeterTest, StreamsHaveARate) {
  const auto [at_once, later] = rate_of(frame(1, 20, kEndHeaders), 100'000);
  EXPECT_EQ(at_once, 2400);
  EXPECT_EQ(later, 2100);
}

TEST_F(FrameMeterTest, AConnectionHasAShareThatOthersDoNotTake) {
  look(many(frame(1, 20, kEndHeaders) + frame(3, 4), 10'000));
  FrameMeter other(shared_);
  other.look(kPreface, now_);
  const std::string calls = many(frame(1, 20, kEndHeaders), 100);
  EXPECT_EQ(other.look(calls, now_).pass, calls.size());
}

TEST_F(FrameMeterTest, SettingsAndSmallFramesHaveARate) {
  EXPECT_EQ(rate_of(frame(4, 0), 1000), std::make_pair(50, 10));
  EXPECT_EQ(rate_of(frame(6, 8), 100'000), std::make_pair(40'000, 20'000));
}

TEST_F(FrameMeterTest, TheWaitIsUntilTheNextMayGo) {
  const auto verdict = look(many(frame(4, 0), 51));
  ASSERT_TRUE(verdict.wait);
  EXPECT_GT(*verdict.wait, now_);
  now_ = *verdict.wait;
  EXPECT_EQ(look(frame(4, 0)).pass, frame(4, 0).size());
}

TEST_F(FrameMeterTest, HeadersWithoutAnEndAreHostile) {
  EXPECT_EQ(look(frame(1, 100)).hostile, "");
  const auto endless = look(many(frame(9, 100), 100));
  EXPECT_NE(endless.hostile, "");
  EXPECT_LE(endless.pass, 17 * frame(9, 100).size());
}

TEST_F(FrameMeterTest, HeadersAreBoundedOverAllTheirFrames) {
  EXPECT_EQ(look(frame(1, 16'000) + many(frame(9, 16'000), 2) + frame(9, 16'000, kEndHeaders)).hostile, "");
  EXPECT_NE(look(frame(1, 16'384) + many(frame(9, 16'384), 4)).hostile, "");
}

TEST_F(FrameMeterTest, HeadersGoOnInTheNextFrame) {
  EXPECT_NE(look(frame(1, 100) + frame(0, 10)).hostile, "");
  FrameMeter other(shared_);
  EXPECT_NE(other.look(kPreface + frame(9, 10, kEndHeaders), now_).hostile, "");
}

}  // namespace
}  // namespace lipofill::server
