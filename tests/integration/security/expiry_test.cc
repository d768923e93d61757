// Tokens end, and with them what they began.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "lipofill/v1/patient_service.grpc.pb.h"
#include "tests/integration/security/secure_fixture.h"

namespace lipofill::testing {
namespace {

using grpc::StatusCode;

class ExpiryTest : public SecureTest {
 protected:
  ExpiryTest() : wards_(caller("ward", "planner"), "ward") {}

  /// Of a planner of the ward, good for so long.
  Caller for_seconds(int seconds) {
    nlohmann::json with = claims("ward", "planner");
    with["exp"] = std::time(nullptr) + seconds;
    return bearer(token(with));
  }
  const Possessions wards_;
};

TEST_F(ExpiryTest, AStreamThatWaitsEndsWithItsToken) {
  const Answer watched =
      for_seconds(3).call_json("FrameService/Watch", R"({"simulation":")" + wards_.simulation + R"("})");
  EXPECT_EQ(watched.code(), StatusCode::UNAUTHENTICATED) << watched.status.error_message();
  EXPECT_EQ(watched.reason(), "TOKEN_EXPIRED");
  EXPECT_FALSE(watched.messages.empty()) << "until then it showed the meshes";
}

TEST_F(ExpiryTest, AStreamThatIsBusyEndsWithItsToken) {
  const Caller planner = caller("ward", "planner");
  ASSERT_TRUE(
      planner.call_json("SimulationService/StartSimulation", R"({"name":")" + wards_.simulation + "\"}").status.ok());
  const Caller soon = for_seconds(2);
  const auto stub = v1::FrameService::NewStub(channel_);
  v1::WatchRequest request;
  request.set_simulation(wards_.simulation);
  const auto context = soon.context();
  const auto stream = stub->Watch(context.get(), request);
  v1::WatchResponse response;
  int frames = 0;
  while (stream->Read(&response)) frames += response.has_frame() ? 1 : 0;
  const grpc::Status ended = stream->Finish();
  EXPECT_EQ(ended.error_code(), StatusCode::UNAUTHENTICATED) << ended.error_message();
  EXPECT_GT(frames, 2);
}

TEST_F(ExpiryTest, AnUploadUnderWayEndsWithItsToken) {
  const Caller soon = for_seconds(2);
  const auto stub = v1::PatientService::NewStub(channel_);
  const auto context = soon.context();
  v1::Scan scan;
  const auto stream = stub->UploadScan(context.get(), &scan);
  v1::UploadScanRequest chunk;
  chunk.set_name(wards_.scan);
  chunk.set_data("v 0 ");
  EXPECT_TRUE(stream->Write(chunk));
  std::this_thread::sleep_for(std::chrono::seconds(3));
  chunk.set_offset(4);
  stream->Write(chunk);
  stream->WritesDone();
  EXPECT_EQ(stream->Finish().error_code(), StatusCode::UNAUTHENTICATED);
  const Answer shown =
      caller("ward", "viewer").call_json("PatientService/GetScan", R"({"name":")" + wards_.scan + "\"}");
  ASSERT_EQ(shown.messages.size(), 1u);
  ASSERT_TRUE(scan.ParseFromString(shown.messages[0]));
  EXPECT_EQ(scan.received_bytes(), 4u) << "what came in time is kept, the rest goes on with a new token";
}

TEST_F(ExpiryTest, ACallAfterwardsSaysWhatIsWrong) {
  const Caller late = for_seconds(-1);
  const Answer answer = late.call_json("PatientService/ListPatients", "{}");
  EXPECT_EQ(answer.code(), StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(answer.reason(), "TOKEN_EXPIRED");
}

#ifdef LIPOFILL_MOVED_CLOCK

/// Has daemons that are started meanwhile load another clock.
class OtherClock {
 public:
  OtherClock() {
    ::setenv("LIPOFILL_TEST_CLOCK", file_.c_str(), 1);
    ::setenv("LD_PRELOAD", LIPOFILL_MOVED_CLOCK, 1);
  }
  ~OtherClock() { end(); }
  static void end() {
    ::unsetenv("LD_PRELOAD");
    ::unsetenv("LIPOFILL_TEST_CLOCK");
  }
  void set_ahead(int seconds) const {
    std::ofstream(file_ + ".new") << seconds;
    std::filesystem::rename(file_ + ".new", file_);
  }

 private:
  TemporaryDirectory directory_;
  const std::string file_ = directory_.file("seconds");
};

class SetClockTest : protected OtherClock, public ExpiryTest {
 protected:
  SetClockTest() { OtherClock::end(); }
};

TEST_F(SetClockTest, AStreamEndsWhenTheClockIsSetPastTheEndOfItsToken) {
  const Caller for_an_hour = for_seconds(3600);
  const auto stub = v1::FrameService::NewStub(channel_);
  v1::WatchRequest request;
  request.set_simulation(wards_.simulation);
  request.set_heartbeat_ms(3'600'000);  // nothing else wakes the stream
  const auto context = for_an_hour.context();
  context->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
  const auto stream = stub->Watch(context.get(), request);
  v1::WatchResponse response;
  ASSERT_TRUE(stream->Read(&response));
  set_ahead(7200);
  while (stream->Read(&response)) {
  }
  const grpc::Status ended = stream->Finish();
  EXPECT_EQ(ended.error_code(), StatusCode::UNAUTHENTICATED) << ended.error_message();
}

#endif

}  // namespace
}  // namespace lipofill::testing
