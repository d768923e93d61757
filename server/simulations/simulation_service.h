#pragma once

#include <functional>
#include <string>

#include "lipofill/v1/simulation_service.grpc.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// Simulations. See proto/lipofill/v1/simulation_service.proto for what each call does.
class SimulationService : public v1::SimulationService::CallbackService {
 public:
  explicit SimulationService(Backend& backend) : backend_(backend) {}

  using Context = grpc::CallbackServerContext;
  using Reactor = grpc::ServerUnaryReactor;
  using Act = std::function<void(Session& session, RequestKey key, Session::Reply reply)>;

  Reactor* CreateSimulation(Context* context, const v1::CreateSimulationRequest* request,
                            v1::Simulation* response) override;
  Reactor* CheckPlan(Context* context, const v1::CheckPlanRequest* request, v1::CheckPlanResponse* response) override;
  Reactor* GetSimulation(Context* context, const v1::GetSimulationRequest* request, v1::Simulation* response) override;
  Reactor* ListSimulations(Context* context, const v1::ListSimulationsRequest* request,
                           v1::ListSimulationsResponse* response) override;
  Reactor* StartSimulation(Context* context, const v1::StartSimulationRequest* request,
                           v1::Simulation* response) override;
  Reactor* PauseSimulation(Context* context, const v1::PauseSimulationRequest* request,
                           v1::Simulation* response) override;
  Reactor* ResumeSimulation(Context* context, const v1::ResumeSimulationRequest* request,
                            v1::Simulation* response) override;
  Reactor* StopSimulation(Context* context, const v1::StopSimulationRequest* request,
                          v1::Simulation* response) override;
  Reactor* DeleteSimulation(Context* context, const v1::DeleteSimulationRequest* request,
                            google::protobuf::Empty* response) override;
  Reactor* Inject(Context* context, const v1::InjectRequest* request, v1::Simulation* response) override;
  Reactor* CreateCheckpoint(Context* context, const v1::CreateCheckpointRequest* request,
                            v1::Checkpoint* response) override;
  Reactor* GetCheckpoint(Context* context, const v1::GetCheckpointRequest* request, v1::Checkpoint* response) override;
  Reactor* ListCheckpoints(Context* context, const v1::ListCheckpointsRequest* request,
                           v1::ListCheckpointsResponse* response) override;
  Reactor* DeleteCheckpoint(Context* context, const v1::DeleteCheckpointRequest* request,
                            google::protobuf::Empty* response) override;
  Reactor* RestoreSimulation(Context* context, const v1::RestoreSimulationRequest* request,
                             v1::Simulation* response) override;
  Reactor* GetSeries(Context* context, const v1::GetSeriesRequest* request, v1::GetSeriesResponse* response) override;
  Reactor* EvaluateSimulation(Context* context, const v1::EvaluateSimulationRequest* request,
                              v1::Evaluation* response) override;
  grpc::ServerWriteReactor<v1::ExportTissueDeckResponse>* ExportTissueDeck(
      Context* context, const v1::ExportTissueDeckRequest* request) override;
  grpc::ServerWriteReactor<v1::FindShapeResponse>* FindShape(Context* context,
                                                             const v1::FindShapeRequest* request) override;

 private:
  /// Adds to an answer what the store does not hold.
  using Amend = std::function<void(v1::Simulation& simulation)>;
  /// Goes on with a simulation that has settled.
  using Continue = std::function<absl::Status(const std::string& id, const RequestKey& key, const Unwanted& unwanted)>;
  /// Has the session act, or goes on with what has settled where a command does so, and answers
  /// with the simulation as it is then; FAILED_PRECONDITION when it has ended, unless an equal
  /// request was carried out before that.
  template <typename Request>
  Reactor* command(Context* context, const Request* request, v1::Simulation* response, const char* what, const Act& act,
                   const Amend& amend = nullptr, const Continue& go_on = nullptr);

  Backend& backend_;
};

}  // namespace lipofill::server
