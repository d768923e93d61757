#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {

/// A square model ready to be simulated, and what is asked of its simulations.
class RunTest : public ServiceTest {
 protected:
  explicit RunTest(std::vector<std::string> arguments = {}) : ServiceTest(std::move(arguments)) {
    create_patient();
    model_ = build_square();
  }

  v1::Simulation create(double end_s, const std::string& id, bool start = true) {
    v1::Simulation simulation;
    const grpc::Status status = create_simulation(square_plan(model_.name(), end_s), id, start, simulation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return simulation;
  }

  template <typename Request, typename Method>
  grpc::Status act(Method method, const std::string& name, v1::Simulation* result = nullptr,
                   const std::string& request_id = "") {
    Request request;
    request.set_name(name);
    request.set_request_id(request_id);
    v1::Simulation simulation;
    const grpc::Status status = call(*simulations_, method, request, simulation);
    if (result != nullptr) *result = simulation;
    return status;
  }
  grpc::Status start(const std::string& name, v1::Simulation* result = nullptr) {
    return act<v1::StartSimulationRequest>(&v1::SimulationService::Stub::StartSimulation, name, result);
  }
  grpc::Status pause(const std::string& name, v1::Simulation* result = nullptr) {
    return act<v1::PauseSimulationRequest>(&v1::SimulationService::Stub::PauseSimulation, name, result);
  }
  grpc::Status resume(const std::string& name, v1::Simulation* result = nullptr) {
    return act<v1::ResumeSimulationRequest>(&v1::SimulationService::Stub::ResumeSimulation, name, result);
  }
  grpc::Status stop(const std::string& name, v1::Simulation* result = nullptr, const std::string& request_id = "") {
    return act<v1::StopSimulationRequest>(&v1::SimulationService::Stub::StopSimulation, name, result, request_id);
  }
  /// Waits until an operation is done.
  v1::Operation await(v1::Operation operation) {
    while (!operation.done()) {
      v1::WaitOperationRequest wait;
      wait.set_name(operation.name());
      if (!call(*operations_, &v1::OperationService::Stub::WaitOperation, wait, operation).ok()) break;
    }
    return operation;
  }
  v1::GetSeriesResponse series(const std::string& name, uint64_t after = 0) {
    v1::GetSeriesRequest request;
    request.set_name(name);
    request.set_after_step(after);
    v1::GetSeriesResponse response;
    const grpc::Status status = call(*simulations_, &v1::SimulationService::Stub::GetSeries, request, response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }
  v1::WatchRequest watch_request(const std::string& name, v1::WatchRequest::Delivery delivery) {
    v1::WatchRequest request;
    request.set_simulation(name);
    request.set_delivery(delivery);
    return request;
  }
  /// Of a viewer of simulations/x.
  grpc::Status acknowledge(const std::string& viewer, const SeenFrame& frame) {
    v1::AcknowledgeFrameRequest request;
    request.set_simulation("simulations/x");
    request.set_viewer(viewer);
    request.set_epoch(frame.slice.epoch());
    request.set_sequence(frame.slice.sequence());
    v1::AcknowledgeFrameResponse response;
    return call(*frames_, &v1::FrameService::Stub::AcknowledgeFrame, request, response);
  }

  v1::Model model_;
};

}  // namespace lipofill::testing
