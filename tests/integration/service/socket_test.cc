// Two daemons and one UNIX socket: the first keeps it as long as it lives.

#include <filesystem>

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

class SocketTest : public ::testing::Test {
 protected:
  /// The daemon also serves a port of its own, by which the fixture knows that it serves.
  std::unique_ptr<DaemonProcess> start(const std::string& data) {
    return std::make_unique<DaemonProcess>(directory_.file(data), std::vector<std::string>{"--listen", address_});
  }
  std::string try_to_start(const std::string& data) {
    std::string output;
    EXPECT_EQ(run_daemon_to_end({"--listen", address_, "--data", directory_.file(data)}, output), 1) << output;
    return output;
  }
  /// Whose patients answer on the socket.
  std::string owner() {
    const auto channel = grpc::CreateChannel(address_, grpc::InsecureChannelCredentials());
    const auto stub = v1::PatientService::NewStub(channel);
    Context context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
    v1::ListPatientsResponse listed;
    const grpc::Status status = stub->ListPatients(&context, v1::ListPatientsRequest(), &listed);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return listed.patients_size() == 1 ? listed.patients(0).name() : "";
  }
  void make_patient(const std::string& id) {
    const auto stub = v1::PatientService::NewStub(grpc::CreateChannel(address_, grpc::InsecureChannelCredentials()));
    v1::CreatePatientRequest request;
    request.set_patient_id(id);
    Context context;
    v1::Patient patient;
    EXPECT_TRUE(stub->CreatePatient(&context, request, &patient).ok());
  }

  TemporaryDirectory directory_;
  const std::string address_ = "unix:" + directory_.file("socket");
};

TEST_F(SocketTest, ASecondDaemonIsRefusedWhileTheFirstLives) {
  const auto first = start("first");
  make_patient("of-the-first");
  EXPECT_THAT(try_to_start("second"), HasSubstr("another lipofilld serves there"));
  EXPECT_EQ(owner(), "patients/of-the-first");
  first->signal(SIGSTOP);
  EXPECT_THAT(try_to_start("second"), HasSubstr("another lipofilld serves there")) << "also when it stands still";
  first->signal(SIGCONT);
  EXPECT_EQ(owner(), "patients/of-the-first");
  EXPECT_EQ(first->terminate(), 0);
  EXPECT_FALSE(std::filesystem::exists(directory_.file("socket"))) << "it takes its socket with it";
}

TEST_F(SocketTest, ADeadOnesSocketIsTakenOver) {
  const auto first = start("first");
  first->kill_hard();
  ASSERT_TRUE(std::filesystem::exists(directory_.file("socket")));
  const auto second = start("second");
  make_patient("of-the-second");
  EXPECT_EQ(owner(), "patients/of-the-second");
  EXPECT_THAT(second->log(), HasSubstr("was left by a daemon that is dead"));
}

}  // namespace
}  // namespace lipofill::testing
