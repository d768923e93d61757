// Credentials that are taken back before their time, and with them what they began.

#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/integration/security/secure_fixture.h"

namespace lipofill::testing {
namespace {

using grpc::StatusCode;

class RevocationTest : public SecureTest {
 protected:
  RevocationTest() {
    revoke("");
    start({"--revoked-file", file_});
  }
  void revoke(const std::string& entries) {
    std::ofstream(file_ + ".new") << R"({"revoked": [)" + entries + "]}";
    std::filesystem::rename(file_ + ".new", file_);
  }
  Caller with_id(const std::string& id) {
    nlohmann::json with = claims("ward", "planner");
    with["jti"] = id;
    return bearer(token(with));
  }
  static Answer list(const Caller& caller) { return caller.call_json("PatientService/ListPatients", "{}"); }
  /// True once the caller is refused: the file is looked at once a second.
  static bool is_refused_soon(const Caller& caller) {
    for (int i = 0; i < 100; ++i) {
      const Answer answer = list(caller);
      if (answer.code() == StatusCode::UNAUTHENTICATED) return answer.reason() == "CREDENTIALS_REVOKED";
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }

  const std::string file_ = directory_.file("revoked.json");
};

TEST_F(RevocationTest, ATokenIsRefusedOnceItIsOnTheList) {
  const Caller one = with_id("one");
  const Caller other = with_id("other");
  EXPECT_TRUE(list(one).status.ok());
  revoke(R"({"token_id": "one"})");
  EXPECT_TRUE(is_refused_soon(one));
  EXPECT_TRUE(list(other).status.ok());
  revoke(R"({"tenant": "ward", "subject": "planner-of-ward"})");
  EXPECT_TRUE(is_refused_soon(other));
  EXPECT_TRUE(list(caller("ward", "viewer")).status.ok());
}

TEST_F(RevocationTest, AListThatCannotBeReadChangesNothing) {
  revoke(R"({"token_id": "one"})");
  EXPECT_TRUE(is_refused_soon(with_id("one")));
  std::ofstream(file_) << "{";
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  EXPECT_EQ(list(with_id("one")).reason(), "CREDENTIALS_REVOKED");
  EXPECT_TRUE(list(with_id("other")).status.ok());
}

TEST_F(RevocationTest, AStreamEndsWithItsCredentials) {
  const Possessions wards(caller("ward", "planner"), "ward");
  const auto stub = v1::FrameService::NewStub(channel_);
  v1::WatchRequest request;
  request.set_simulation(wards.simulation);
  const auto context = with_id("watching").context();
  const auto stream = stub->Watch(context.get(), request);
  v1::WatchResponse response;
  ASSERT_TRUE(stream->Read(&response));
  revoke(R"({"token_id": "watching"})");
  while (stream->Read(&response)) {
  }
  const grpc::Status ended = stream->Finish();
  EXPECT_EQ(ended.error_code(), StatusCode::UNAUTHENTICATED) << ended.error_message();
  EXPECT_THAT(ended.error_message(), ::testing::HasSubstr("were revoked"));
}

}  // namespace
}  // namespace lipofill::testing
