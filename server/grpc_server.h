#pragma once

#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <chrono>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/backend/backend.h"
#include "server/door/door.h"
#include "server/door/knock.h"
#include "server/entry/call_gate.h"
#include "server/frames/frame_service.h"
#include "server/ops/periodic.h"
#include "server/ops/socket_claim.h"
#include "server/patients/operation_service.h"
#include "server/patients/patient_service.h"
#include "server/patients/plan_service.h"
#include "server/planning/forecast_service.h"
#include "server/planning/planning_service.h"
#include "server/simulations/simulation_service.h"

namespace lipofill::server {

/// The guards of the services.
struct ServiceGuard {
  const SecuritySettings& settings;
  const Authenticator& authenticator;
  AuditLog* audit = nullptr;  ///< nullptr: nothing is written down
  bool reflection = true;
};

/// The services on TCP ports and UNIX sockets, with standard health and reflection. Connections
/// come through the Door, and every call passes CallWatchers.
class GrpcServer {
 public:
  /// @param addresses  host:port (port 0 takes a free one) or unix:path. Users of the socket's
  ///                   group may write to it.
  /// @param guard      who may do what; outlives the server. TCP is served with TLS where it has
  ///                   that.
  /// @param bounds     the connections that may be open
  /// UNAVAILABLE when one cannot be listened on, also when another program already does;
  /// FAILED_PRECONDITION for a UNIX socket on which somebody serves.
  static absl::StatusOr<std::unique_ptr<GrpcServer>> start(const std::vector<std::string>& addresses,
                                                           const ServiceGuard& guard, const DoorBounds& bounds,
                                                           Backend& backend);
  ~GrpcServer();

  /// Port of the first address on TCP; 0 when there is none.
  int port() const { return port_; }
  const DoorFigures& door_figures() const { return door_.figures(); }
  /// Connects to each of its own addresses. UNAVAILABLE saying which cannot be reached, and why.
  absl::Status check_reachable() const;
  /// Tells health what a self check found. A server that drains stays NOT_SERVING.
  void set_reachable(bool reachable);

  using Seconds = std::chrono::duration<double>;
  /// Ends the service, in order: health turns NOT_SERVING and nothing new is taken; after `delay`
  /// viewers' streams end with draining(), simulations stand still with their state kept, for the
  /// next start to go on from, builds are cancelled, calls under way are answered or, after some
  /// seconds of `timeout`, cut off. Returns when all have ended; within `timeout` but for work that
  /// does not look at the clock (a step, a build). False when gRPC still waits for clients that
  /// neither read nor leave: all work is done, but the program must end without destroying the
  /// server.
  /// Checked by tests/integration/service/drain_test.cc.
  bool drain(Seconds delay, Seconds timeout);

 private:
  GrpcServer(const ServiceGuard& guard, const DoorBounds& bounds, Backend& backend);
  absl::Status listen(const std::vector<std::string>& addresses, bool is_encrypted);
  absl::Status open_door();
  /// Becomes ready when the last call has ended; calls that have not within `grace` are cancelled.
  std::future<void> end_calls(Seconds grace);

  std::vector<SocketClaim> claims_;  ///< first: they outlast the server, which removes its sockets
  Backend& backend_;
  CallGate gate_;
  struct Services {
    explicit Services(Backend& backend)
        : patients(backend),
          operations(backend),
          simulations(backend),
          frames(backend),
          planning(backend),
          plans(backend),
          forecasts(backend) {}
    PatientService patients;
    OperationService operations;
    SimulationService simulations;
    FrameService frames;
    PlanningService planning;
    PlanService plans;
    ForecastService forecasts;
  };
  Services services_;
  std::unique_ptr<grpc::Server> server_;
  using Acceptor = std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor>;
  Acceptor plain_;
  Acceptor encrypted_;
  struct Listener {
    bool is_encrypted = false;
    OwnAddress own;
  };
  std::vector<Listener> listeners_;  ///< of the door, in its order
  int port_ = 0;
  std::mutex health_mutex_;
  Door door_;
  std::unique_ptr<Periodic> sweeper_;  ///< last: its thread uses the others
};

}  // namespace lipofill::server
