// File, environment and command line of the real daemon.

#include <cstdlib>
#include <fstream>

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ConfigurationTest : public ::testing::Test {
 protected:
  ~ConfigurationTest() override {
    for (const char* name : {"LIPOFILLD_WORKERS", "LIPOFILLD_CONFIG", "LIPOFILLD_LISTEN", "LIPOFILLD_SERVICE_HOST"}) {
      ::unsetenv(name);
    }
  }
  std::string write_file(const std::string& text) {
    const std::string path = directory_.file("lipofilld.toml");
    std::ofstream(path) << text;
    return path;
  }
  int check(std::vector<std::string> arguments) {
    arguments.push_back("--check");
    return run_daemon_to_end(arguments, output_);
  }

  TemporaryDirectory directory_;
  std::string output_;
};

TEST_F(ConfigurationTest, TheSampleIsGoodAndSaysTheDefaults) {
  EXPECT_EQ(check({"--config", LIPOFILL_DEPLOY "/lipofilld.toml"}), 0) << output_;
  EXPECT_THAT(output_, HasSubstr("configuration is good"));
  EXPECT_THAT(output_, Not(HasSubstr("# default"))) << "the sample has every setting";
}

TEST_F(ConfigurationTest, TheCommandLineWinsOverTheEnvironmentAndThatOverTheFile) {
  const std::string file = write_file("workers = 3\nmax-simulations = 9\nlisten = [\"127.0.0.1:1\"]\n");
  EXPECT_EQ(check({"--config", file}), 0) << output_;
  EXPECT_THAT(output_, HasSubstr("workers = 3  # " + file));
  ::setenv("LIPOFILLD_WORKERS", "4", 1);
  ::setenv("LIPOFILLD_LISTEN", "127.0.0.1:2,unix:/tmp/socket", 1);
  EXPECT_EQ(check({"--config", file}), 0) << output_;
  EXPECT_THAT(output_, HasSubstr("workers = 4  # LIPOFILLD_WORKERS"));
  EXPECT_THAT(output_, HasSubstr("listen = [\"127.0.0.1:2\", \"unix:/tmp/socket\"]  # LIPOFILLD_LISTEN"));
  EXPECT_THAT(output_, HasSubstr("max-simulations = 9  # " + file));
  ::setenv("LIPOFILLD_CONFIG", file.c_str(), 1);
  ::setenv("LIPOFILLD_SERVICE_HOST", "10.0.0.1", 1);
  EXPECT_EQ(check({"--workers", "5"}), 0) << output_;
  EXPECT_THAT(output_, HasSubstr("workers = 5  # --workers"));
  EXPECT_THAT(output_, HasSubstr("max-simulations = 9"));
}

TEST_F(ConfigurationTest, EveryMistakeIsNamedWithItsValueItsSourceAndItsBound) {
  const std::string file = write_file("drain-timeout-s = 0.5\nlog-format = \"xml\"\n");
  ::setenv("LIPOFILLD_WORKERS", "many", 1);
  EXPECT_EQ(check({"--config", file, "--max-simulations", "0", "--metrics-listen", "9464"}), 2);
  EXPECT_THAT(output_, HasSubstr("drain-timeout-s: is \"0.5\" (from " + file + "), must be a number in [1, 3600]"));
  EXPECT_THAT(output_, HasSubstr("log-format: is \"xml\" (from " + file + "), must be one of text, json"));
  EXPECT_THAT(output_, HasSubstr("workers: is \"many\" (from LIPOFILLD_WORKERS), must be an integer in [1, 256]"));
  EXPECT_THAT(output_, HasSubstr("max-simulations: is \"0\" (from --max-simulations)"));
  EXPECT_THAT(output_, HasSubstr("metrics-listen: is \"9464\", must be HOST:PORT"));
  EXPECT_EQ(check({"--config", write_file("wrokers = 3\n")}), 2);
  EXPECT_THAT(output_, HasSubstr("wrokers: in "));
  EXPECT_EQ(check({"--config", directory_.file("none")}), 2);
  EXPECT_THAT(output_, HasSubstr("cannot be read"));
  EXPECT_EQ(check({"--drain-delay-s", "30"}), 2);
  EXPECT_THAT(output_, HasSubstr("drain-delay-s: is 30, must be below drain-timeout-s, 30"));
}

TEST_F(ConfigurationTest, AMistakeKeepsTheDaemonFromStarting) {
  EXPECT_EQ(run_daemon_to_end({"--workers", "0", "--data", directory_.file("data")}, output_), 2);
  EXPECT_FALSE(std::filesystem::exists(directory_.file("data")));
}

TEST_F(ConfigurationTest, PlainTextStaysOnTheMachineUnlessTold) {
  for (const char* address : {"0.0.0.0:0", "[::]:0", "192.0.2.1:50061"}) {
    EXPECT_EQ(check({"--listen", address}), 2) << address;
    EXPECT_THAT(output_, HasSubstr("others on the network reach"));
    EXPECT_EQ(check({"--listen", address, "--insecure-listen-anywhere"}), 0) << output_;
  }
  EXPECT_EQ(check({"--listen", "127.0.0.1:0", "--listen", "0.0.0.0:0"}), 2) << "one is enough";
}

class UnixSocketTest : public ConfigurationTest {};

TEST_F(UnixSocketTest, ServesBesideTcpAndOnlyForUserAndGroup) {
  const std::string path = directory_.file("socket");
  DaemonProcess daemon(directory_.file("data"), {"--listen", "unix:" + path});
  for (const std::string& address : {"unix:" + path, daemon.address()}) {
    const auto channel = grpc::CreateChannel(address, grpc::InsecureChannelCredentials());
    const auto patients = v1::PatientService::NewStub(channel);
    v1::ListPatientsResponse response;
    const grpc::Status status =
        call(*patients, &v1::PatientService::Stub::ListPatients, v1::ListPatientsRequest(), response);
    EXPECT_TRUE(status.ok()) << address << ": " << status.error_message();
  }
  daemon.kill_hard();
  DaemonProcess again(directory_.file("data"), {"--listen", "unix:" + path});
  const auto patients =
      v1::PatientService::NewStub(grpc::CreateChannel("unix:" + path, grpc::InsecureChannelCredentials()));
  v1::ListPatientsResponse response;
  EXPECT_TRUE(call(*patients, &v1::PatientService::Stub::ListPatients, v1::ListPatientsRequest(), response).ok())
      << "what a killed daemon leaves behind is in nobody's way";
  using std::filesystem::perms;
  EXPECT_EQ(std::filesystem::status(path).permissions() & perms::others_all, perms::none);
  EXPECT_EQ(again.terminate(), 0);
}

TEST_F(UnixSocketTest, SaysThatItsDirectoryCannotBeWrittenTo) {
  const std::string address = "unix:" + directory_.file("no such directory") + "/socket";
  std::string output;
  EXPECT_EQ(run_daemon_to_end({"--data", directory_.file("data"), "--listen", address}, output), 1);
  EXPECT_THAT(output, HasSubstr("cannot listen on " + address + ": "));
  EXPECT_THAT(output, HasSubstr("may this user make files in its directory?"));
}

/// Also in a directory that others may look into.
TEST_F(ConfigurationTest, WhatItWritesIsForItsUserAlone) {
  const std::filesystem::path data = directory_.file("data");
  std::filesystem::create_directory(data);
  {
    DaemonProcess daemon(data);
    const auto patients =
        v1::PatientService::NewStub(grpc::CreateChannel(daemon.address(), grpc::InsecureChannelCredentials()));
    v1::Patient patient;
    ASSERT_TRUE(call(*patients, &v1::PatientService::Stub::CreatePatient, v1::CreatePatientRequest(), patient).ok());
    EXPECT_EQ(daemon.terminate(), 0);
  }
  int entries = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data)) {
    using std::filesystem::perms;
    EXPECT_EQ(entry.status().permissions() & (perms::group_all | perms::others_all), perms::none) << entry.path();
    ++entries;
  }
  EXPECT_GE(entries, 4) << "the database, the lock, scans and checkpoints";
}

}  // namespace
}  // namespace lipofill::testing
