// One caller who floods a connection: what it costs the daemon, and the others.

#include <fstream>
#include <sstream>

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
  /// The frames that end a call or the connection, for so long as some come.
  static std::vector<SeenFrameHeader> read_all(RawHttp2& client, double patience_s) {
    std::vector<SeenFrameHeader> frames;
    for (SeenFrameHeader frame; client.read(frame, patience_s);) frames.push_back(frame);
    return frames;
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
    for (const SeenFrameHeader& frame : read_all(front, 1.0)) {
      EXPECT_NE(frame.type, FrameType::kGoAway) << size;
      EXPECT_FALSE(frame.stream == 1 && (frame.flags & RawHttp2::kEndStream) != 0) << "the watch ends at " << size;
      is_answered = is_answered || frame.stream == stream;
    }
    EXPECT_TRUE(is_answered) << size;
  }
  EXPECT_TRUE(others_are_served());
}

/// A daemon with patients whose names are long, for answers that are large.
class UnreadTest : public FloodTest {
 protected:
  UnreadTest() {
    const Caller planner = caller("ward", "planner");
    const std::string label(60, 'n');
    for (int i = 0; i < 1000; ++i) {
      const std::string request = R"({"patientId":"ward-)" + std::to_string(i) + R"(","displayName":")" + label + "\"}";
      EXPECT_TRUE(planner.call_json("PatientService/CreatePatient", request).status.ok());
    }
    before_mb_ = resident_mb();
  }
};

TEST_F(UnreadTest, AnswersThatNobodyReadsAreBounded) {
  const std::string method = "/lipofill.v1.PatientService/ListPatients";
  const RawHttp2::Headers who = {{"authorization", "Bearer " + token(claims("ward", "viewer"))}};
  const std::string page("\x08\xe8\x07", 3);  // page_size: 1000
  double most_mb = 0.0;
  std::vector<std::unique_ptr<RawHttp2>> clients;
  int refused = 0;
  for (int client = 0; client < 8; ++client) {
    clients.push_back(std::make_unique<RawHttp2>(port(), 0));  // there is no room for any answer
    for (uint32_t stream = 1; stream < 500; stream += 2) {
      if (!clients.back()->send(RawHttp2::whole_call(stream, method, page, who), 5.0)) break;
    }
    for (const SeenFrameHeader& frame : read_all(*clients.back(), 1.0)) {
      const bool is_end = frame.type == FrameType::kHeaders && (frame.flags & RawHttp2::kEndStream) != 0;
      refused += is_end ? 1 : 0;
    }
    most_mb = std::max(most_mb, grown_mb());
  }
  EXPECT_GT(refused, 0) << "of 2,000 answers some are refused";
  // 64 MiB of answers, and some four times that of what they are made from.
  EXPECT_LT(most_mb, 330.0);
  EXPECT_TRUE(caller("ward", "planner").call_json("PatientService/ListPatients", "{}").status.ok())
      << "it is nobody else's bound";
  clients.clear();
}

}  // namespace
}  // namespace lipofill::testing
