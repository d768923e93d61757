// The program itself: health, reflection, options, its directory, its end.

#include <grpcpp/generic/generic_stub.h>

#include <fstream>

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

class DaemonTest : public ServiceTest {};

TEST_F(DaemonTest, IsHealthy) {
  EXPECT_TRUE(is_serving());
}

TEST_F(DaemonTest, ReflectsItsServices) {
  grpc::GenericStub stub(channel_);
  Context context;
  grpc::CompletionQueue queue;
  void* tag = nullptr;
  bool ok = false;
  auto stream = stub.PrepareCall(&context, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", &queue);
  stream->StartCall(nullptr);
  ASSERT_TRUE(queue.Next(&tag, &ok) && ok);
  // ServerReflectionRequest { list_services: "" }, field 7
  const grpc::Slice request_bytes(std::string("\x3a\x00", 2));
  stream->Write(grpc::ByteBuffer(&request_bytes, 1), nullptr);
  ASSERT_TRUE(queue.Next(&tag, &ok) && ok);
  grpc::ByteBuffer response;
  stream->Read(&response, nullptr);
  ASSERT_TRUE(queue.Next(&tag, &ok) && ok);
  grpc::Slice slice;
  ASSERT_TRUE(response.DumpToSingleSlice(&slice).ok());
  const std::string bytes(reinterpret_cast<const char*>(slice.begin()), slice.size());
  for (const char* service : {"lipofill.v1.PatientService", "lipofill.v1.SimulationService", "lipofill.v1.FrameService",
                              "lipofill.v1.OperationService", "grpc.health.v1.Health"}) {
    EXPECT_THAT(bytes, HasSubstr(service));
  }
  context.TryCancel();
  grpc::Status status;
  stream->Finish(&status, nullptr);
  queue.Next(&tag, &ok);
}

TEST_F(DaemonTest, SharesNeitherItsPortNorItsDirectory) {
  std::string output;
  EXPECT_EQ(run_daemon_to_end({"--listen", daemon_->address(), "--data", directory_.file("other")}, output), 1);
  EXPECT_THAT(output, HasSubstr("cannot listen on"));
  EXPECT_EQ(run_daemon_to_end({"--listen", "127.0.0.1:0", "--data", directory_.file("data")}, output), 1);
  EXPECT_THAT(output, HasSubstr("in use by another"));
  EXPECT_TRUE(is_serving());
}

TEST_F(DaemonTest, StopsOnSignalsWithinSeconds) {
  const auto begin = std::chrono::steady_clock::now();
  daemon_->signal(SIGINT);
  EXPECT_EQ(daemon_->wait(), 0);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST(DaemonOptions, ExplainThemselves) {
  std::string output;
  EXPECT_EQ(run_daemon_to_end({"--help"}, output), 0);
  for (const char* text : {"--listen", "--data", "--workers", "--port-file", "Examples", "not a medical device"}) {
    EXPECT_THAT(output, HasSubstr(text));
  }
  EXPECT_EQ(run_daemon_to_end({"--version"}, output), 0);
  EXPECT_THAT(output, HasSubstr("lipofilld "));
  EXPECT_EQ(run_daemon_to_end({"--workers", "0"}, output), 2);
  EXPECT_EQ(run_daemon_to_end({"--nonsense"}, output), 2);
  EXPECT_THAT(output, HasSubstr("--nonsense"));
}

TEST(DaemonData, IsCheckedBeforeServing) {
  TemporaryDirectory directory;
  std::string output;
  std::ofstream(directory.file("lipofill.sqlite")) << std::string(10'000, 'x');
  EXPECT_EQ(run_daemon_to_end({"--listen", "127.0.0.1:0", "--data", directory.path().string()}, output), 1);
  EXPECT_THAT(output, HasSubstr("not a database"));
  EXPECT_EQ(run_daemon_to_end({"--listen", "127.0.0.1:0", "--data", "/proc/lipofill"}, output), 1);
  EXPECT_THAT(output, HasSubstr("cannot make"));
}

}  // namespace
}  // namespace lipofill::testing
