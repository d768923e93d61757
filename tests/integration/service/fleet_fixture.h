#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/integration/service/run_fixture.h"
#include "tests/unit/server/postgres_server.h"

namespace lipofill::testing {

/// One of the daemons that share a database and a directory.
struct FleetDaemon {
  FleetDaemon(const std::string& data, const std::vector<std::string>& arguments) : process(data, arguments) {
    channel = grpc::CreateChannel(process.address(), grpc::InsecureChannelCredentials());
    patients = v1::PatientService::NewStub(channel);
    simulations = v1::SimulationService::NewStub(channel);
  }

  DaemonProcess process;
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::PatientService::Stub> patients;
  std::unique_ptr<v1::SimulationService::Stub> simulations;
};

/// A daemon called "a", which is that of ServiceTest, and others beside it.
class FleetTest : public RunTest {
 protected:
  FleetTest() : FleetTest(PostgresServer::of_program().make_place()) {}
  explicit FleetTest(const std::string& place) : RunTest(arguments_of(place, "a")), place_(place) {}

  static std::vector<std::string> arguments_of(const std::string& place, const std::string& name) {
    return {"--store", place, "--name", name, "--checkpoint-interval-s", "0.05", "--metrics-listen", "127.0.0.1:0"};
  }
  /// The directory under another path: a daemon's log and its port are written beside it.
  std::string data_of(const std::string& name) {
    const std::string data = directory_.file("data-" + name);
    std::error_code is_there;
    std::filesystem::create_directory_symlink(directory_.file("data"), data, is_there);
    return data;
  }
  std::unique_ptr<FleetDaemon> add(const std::string& name) {
    return std::make_unique<FleetDaemon>(data_of(name), arguments_of(place_, name));
  }

  void await_step(const std::string& name, uint64_t step) { await_step_at(*simulations_, name, step); }

  /// Asks one of them; what is UNAVAILABLE, while a simulation changes hands, is asked again.
  template <typename Request, typename Response, typename Method>
  grpc::Status insist(v1::SimulationService::Stub& stub, Method method, const Request& request, Response& response) {
    grpc::Status status;
    do {
      status = call(stub, method, request, response);
      if (status.error_code() != grpc::StatusCode::UNAVAILABLE) return status;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    } while (true);
  }
  v1::Simulation get(v1::SimulationService::Stub& stub, const std::string& name) {
    v1::GetSimulationRequest request;
    request.set_name(name);
    v1::Simulation simulation;
    const grpc::Status status = insist(stub, &v1::SimulationService::Stub::GetSimulation, request, simulation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return simulation;
  }
  v1::Simulation await_end_at(v1::SimulationService::Stub& stub, const std::string& name) {
    v1::Simulation simulation = get(stub, name);
    while (!has_ended(simulation.state()) && !HasFailure()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      simulation = get(stub, name);
    }
    return simulation;
  }
  void await_step_at(v1::SimulationService::Stub& stub, const std::string& name, uint64_t step) {
    while (get(stub, name).summary().steps() < step && !HasFailure()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  v1::GetSeriesResponse series_at(v1::SimulationService::Stub& stub, const std::string& name) {
    v1::GetSeriesRequest request;
    request.set_name(name);
    v1::GetSeriesResponse response;
    EXPECT_TRUE(insist(stub, &v1::SimulationService::Stub::GetSeries, request, response).ok());
    return response;
  }
  static void expect_every_step_once(const v1::GetSeriesResponse& series, uint64_t n_steps) {
    ASSERT_EQ(static_cast<uint64_t>(series.rows_size()), n_steps);
    for (int i = 0; i < series.rows_size(); ++i) ASSERT_EQ(series.rows(i).step(), static_cast<uint64_t>(i) + 1);
  }
  static void await_log(const DaemonProcess& daemon, const std::string& text) {
    while (daemon.log().find(text) == std::string::npos && daemon.running()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_TRUE(daemon.running()) << daemon.log();
  }

  const std::string place_;
};

}  // namespace lipofill::testing
