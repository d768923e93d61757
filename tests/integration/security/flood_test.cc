// One caller who floods a connection: what it costs the daemon, and the others.

#include <fstream>
#include <sstream>
#include <thread>

#include "tests/integration/security/raw_http2.h"
#include "tests/integration/security/secure_fixture.h"
#include "tests/integration/service/footprint.h"

namespace lipofill::testing {
namespace {

using grpc::StatusCode;

constexpr char kHealth[] = "/grpc.health.v1.Health/Check";
constexpr char kHealthWatch[] = "/grpc.health.v1.Health/Watch";
constexpr char kCancel[] = {0, 0, 0, 8};

class FloodTest : public SecureTest {
 protected:
  FloodTest() {
    EXPECT_TRUE(others_are_served());
    before_mb_ = resident_mb();
  }

  int port() const { return std::stoi(daemon_->address().substr(daemon_->address().find(':') + 1)); }
  double resident_mb() const { return read_footprint(daemon_->pid()).resident_mb; }
  double grown_mb() const { return resident_mb() - before_mb_; }
  bool others_are_served() {
    return caller("ward", "viewer").call_json("PatientService/ListPatients", "{}").status.ok();
  }

  double before_mb_ = 0.0;
};

TEST_F(FloodTest, StreamsThatAreOpenedAndResetCostNoMemory) {
  RawHttp2 stranger(port());
  const std::string headers = RawHttp2::call_headers(kHealth);
  uint32_t stream = 1;
  double most_mb = 0.0;
  bool takes = true;
  // What is sent beyond the rate waits with its sender: so much is, until the socket is full.
  for (int batch = 0; takes && batch < 1000; ++batch) {
    std::string frames;
    for (int i = 0; i < 100; ++i, stream += 2) {
      frames += RawHttp2::frame(FrameType::kHeaders, RawHttp2::kEndHeaders, stream, headers);
      frames += RawHttp2::frame(FrameType::kResetStream, 0, stream, std::string_view(kCancel, sizeof kCancel));
    }
    takes = stranger.send(frames, 3.0) && stranger.skim();
    most_mb = std::max(most_mb, grown_mb());
  }
  EXPECT_FALSE(takes) << stream / 2 << " streams were taken";
  EXPECT_LT(most_mb, 60.0);
  EXPECT_TRUE(others_are_served());
}

TEST_F(FloodTest, HeadersWithoutAnEndEndTheirConnection) {
  RawHttp2 stranger(port());
  const std::string part(16'000, '\0');
  ASSERT_TRUE(stranger.send(RawHttp2::frame(FrameType::kHeaders, 0, 1, RawHttp2::call_headers(kHealth))));
  const std::string more = RawHttp2::frame(FrameType::kContinuation, 0, 1, part);
  int sent = 0;
  while (sent < 10'000 && stranger.send(more, 3.0)) ++sent;
  EXPECT_LT(sent, 1000);
  EXPECT_LT(grown_mb(), 20.0);
  EXPECT_TRUE(others_are_served());
}

TEST_F(FloodTest, OpenCallsOfStrangersAreBounded) {
  std::vector<std::unique_ptr<RawHttp2>> strangers;
  int refused = 0;
  for (int stranger = 0; stranger < 24; ++stranger) {
    strangers.push_back(std::make_unique<RawHttp2>(port()));
    std::string calls;
    for (uint32_t stream = 1; stream < 500; stream += 2) calls += RawHttp2::whole_call(stream, kHealthWatch, "");
    ASSERT_TRUE(strangers.back()->send(calls));
    for (const SeenFrameHeader& frame : strangers.back()->read_all(0.3)) {
      const bool is_end = frame.type == FrameType::kHeaders && (frame.flags & RawHttp2::kEndStream) != 0;
      refused += is_end || frame.type == FrameType::kResetStream ? 1 : 0;
    }
  }
  EXPECT_GT(refused, 3000) << "of 6,000 some 2,000 stay open";
  EXPECT_LT(grown_mb(), 90.0);
  EXPECT_TRUE(others_are_served());
  strangers.clear();
  for (int i = 0; i < 100 && grown_mb() > 30.0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_LT(grown_mb(), 30.0) << "of strangers who have left";
}

TEST_F(FloodTest, SettingsAndPingsCostNoMemory) {
  RawHttp2 stranger(port());
  std::string frames;
  for (int i = 0; i < 2000; ++i) {
    frames += RawHttp2::frame(FrameType::kSettings, 0, 0, "");
    frames += RawHttp2::frame(FrameType::kPing, 0, 0, "12345678");
  }
  // The answers are not read.
  for (int batch = 0; batch < 200 && stranger.send(frames, 2.0); ++batch) {
  }
  EXPECT_LT(grown_mb(), 20.0);
  EXPECT_TRUE(others_are_served());
}

TEST_F(FloodTest, HeadersThatAFrontLetsByEndNoOtherCallOfTheConnection) {
  RawHttp2 front(port());
  ASSERT_TRUE(front.send(RawHttp2::whole_call(1, kHealthWatch, "")));
  for (const size_t size : {7000u, 8000u, 9000u, 16'000u}) {
    const auto stream = static_cast<uint32_t>(size / 10 * 2 + 1);
    const RawHttp2::Headers large = {{"authorization", std::string(size, 'x')}};
    ASSERT_TRUE(front.send(RawHttp2::whole_call(stream, "/lipofill.v1.PatientService/ListPatients", "", large)));
    bool is_answered = false;
    for (const SeenFrameHeader& frame : front.read_all(1.0)) {
      EXPECT_NE(frame.type, FrameType::kGoAway) << size;
      EXPECT_FALSE(frame.stream == 1 && (frame.flags & RawHttp2::kEndStream) != 0) << "the watch ends at " << size;
      is_answered = is_answered || frame.stream == stream;
    }
    EXPECT_TRUE(is_answered) << size;
  }
  EXPECT_TRUE(others_are_served());
}

}  // namespace
}  // namespace lipofill::testing
